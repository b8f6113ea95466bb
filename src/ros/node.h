#pragma once

#include <condition_variable>
#include <mutex>
#include <optional>
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

}  // namespace mrhi
