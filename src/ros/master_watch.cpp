#include "node.h"

#include <ros/console.h>
#include <ros/init.h>
#include <ros/master.h>
#include <ros/this_node.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include <chrono>

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

}  // namespace

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

}  // namespace mrhi
