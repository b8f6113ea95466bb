#include <ros/ros.h>

#include <exception>

#include "../ros/marker_relay.h"
#include "../ros/node.h"

namespace {

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction marker_relay_node [_PARAMETER:=VALUE]... [TOPIC:=OTHER]...

Takes markers, and publishes some of them on view/markers for rviz on another machine, while somebody views.

  ~rate        arrays per second; default 30
  ~leave_out   layers that are not passed on, with commas between them; default none
)";

}  // namespace

int main(int argc, char** argv) {
  if (const auto status = mrhi::status_of_arguments(argc, argv, kUsage)) return *status;
  ros::init(argc, argv, "marker_relay_node");
  mrhi::end_in_order();
  const ros::NodeHandle node, parameters("~");  // outlive what may throw: without a node nothing is logged
  const mrhi::MasterWatch master;
  try {
    const mrhi::MarkerRelay relay(node, parameters);
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
