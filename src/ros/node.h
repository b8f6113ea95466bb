#pragma once

#include <ros/ros.h>

#include <condition_variable>
#include <mutex>
#include <optional>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>

namespace mrhi {

/// What a node's arguments alone decide, before there is a master: --help prints the usage, 0; an argument
/// that is not roslaunch's is told in one line, 2. Nothing: the node is to run.
std::optional<int> status_of_arguments(int argc, char** argv, const char* usage);

/// Says in the log when the ROS master is gone, and when one is there again that does not know this node:
/// what is connected goes on without a master, but nobody new can find the node until it is started again.
/// Asks in a thread of its own, as a master on a network that is down keeps who asks waiting.
class MasterWatch {
 public:
  MasterWatch();
  ~MasterWatch();
  MasterWatch(const MasterWatch&) = delete;
  MasterWatch& operator=(const MasterWatch&) = delete;

 private:
  void run();

  std::mutex mutex_;
  std::condition_variable ended_;
  bool end_ = false;
  std::thread thread_;
};

/// SIGTERM, SIGHUP and SIGQUIT end ros::spin() as SIGINT does, so that what a node has begun is brought to
/// its end. Call after ros::init().
void end_in_order();

/// A private parameter of the node, if it is set. Throws std::invalid_argument if it is of another type.
template <class T>
void read_parameter(const ros::NodeHandle& parameters, const std::string& name, const char* type, T& value) {
  if (!parameters.hasParam(name) || parameters.getParam(name, value)) return;
  throw std::invalid_argument("parameter " + parameters.resolveName(name) + " must be " + type);
}

/// Throws std::invalid_argument that lists the known ones.
void refuse_unknown(const ros::NodeHandle& parameters, const std::set<std::string>& known);

/// Parameter seed, a whole number of at least 0.
std::uint64_t read_seed(const ros::NodeHandle& parameters, std::uint64_t otherwise);

}  // namespace mrhi
