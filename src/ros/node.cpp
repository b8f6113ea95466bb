#include "node.h"

#include <ros/console.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <chrono>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <iostream>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace mrhi {
namespace {

constexpr std::chrono::seconds kPeriod(2);

enum class Standing { known, unknown, no_master };

Standing standing() {
  XmlRpc::XmlRpcValue request, response, payload;
  request[0] = request[1] = ros::this_node::getName();
  if (ros::master::execute("lookupNode", request, response, payload, false)) return Standing::known;
  return response.valid() ? Standing::unknown : Standing::no_master;
}

/// A node that has nothing registered yet is not known either.
void tell(Standing before, Standing now) {
  const char* const uri = ros::master::getURI().c_str();
  if (now == Standing::no_master)
    ROS_WARN("no ROS master at %s any more; what is connected goes on, nothing new can connect", uri);
  if (now == Standing::unknown)
    ROS_ERROR(
        "the ROS master at %s has been started anew and does not know this node; what is connected goes on, "
        "nothing new can connect: start this node again",
        uri);
  if (now == Standing::known && before == Standing::no_master) ROS_INFO("the ROS master at %s is back", uri);
}

/// Logs when the ROS master is gone, and when one is there again that does not know this node:
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

MasterWatch::MasterWatch() : thread_([this] { run(); }) {}

MasterWatch::~MasterWatch() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    end_ = true;
  }
  ended_.notify_all();
  thread_.join();
}

void MasterWatch::run() {
  bool was_known = false;
  Standing before = Standing::known;
  std::unique_lock<std::mutex> lock(mutex_);
  while (!ended_.wait_for(lock, kPeriod, [this] { return end_; })) {
    lock.unlock();
    const Standing now = standing();
    lock.lock();
    was_known = was_known || now == Standing::known;
    if (end_ || !was_known || !ros::ok()) continue;
    if (now != before) tell(before, now);
    before = now;
  }
}

/// What a node's arguments alone decide, before there is a master; nothing: the node is to run.
std::optional<int> status_of_arguments(int argc, char** argv, const char* usage) {
  std::vector<std::string> words;
  ros::removeROSArgs(argc, argv, words);
  if (words.size() < 2) return std::nullopt;
  if (words[1] == "--help" || words[1] == "-h") {
    std::cout << usage;
    return 0;
  }
  const std::string name = words[0].substr(words[0].rfind('/') + 1);
  std::cerr << name << ": unknown argument '" << words[1]
            << "'; allowed: --help; parameters and topics are set as _NAME:=VALUE and TOPIC:=OTHER\n";
  return 2;
}

/// So that what a node has begun is brought to its end. Call after ros::init().
void end_in_order() {
  struct sigaction action {};
  action.sa_handler = [](int) { ros::requestShutdown(); };  // sets a flag
  for (const int signal : {SIGTERM, SIGHUP, SIGQUIT}) sigaction(signal, &action, nullptr);
}

}  // namespace

int run_node(int argc, char** argv, const char* name, const char* usage, const NodeBody& body) {
  if (const auto status = status_of_arguments(argc, argv, usage)) return *status;
  return run_node(argc, argv, name, body);
}

int run_node(int argc, char** argv, const char* name, const NodeBody& body) {
  ros::init(argc, argv, name);
  end_in_order();
  const ros::NodeHandle node, private_node("~");  // outlive what may throw: without a node nothing is logged
  const MasterWatch master;
  try {
    body(node, private_node);
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}

void refuse_unknown(const ros::NodeHandle& parameters, const std::set<std::string>& known) {
  std::vector<std::string> names;
  ros::param::getParamNames(names);
  const std::string space = parameters.getNamespace() + "/";
  for (const std::string& name : names) {
    if (name.compare(0, space.size(), space) != 0 || known.count(name.substr(space.size())) > 0) continue;
    std::string list;
    for (const std::string& one : known) list += (list.empty() ? "" : ", ") + one;
    throw std::invalid_argument("parameter " + name + " is not known: use " + list);
  }
}

std::uint64_t read_seed(const ros::NodeHandle& parameters, std::uint64_t otherwise) {
  int seed = static_cast<int>(otherwise);
  read_parameter(parameters, "seed", "an integer", seed);
  if (seed < 0) throw std::invalid_argument("seed is " + std::to_string(seed) + ": use 0 or more");
  return static_cast<std::uint64_t>(seed);
}

}  // namespace mrhi
