#include <ros/ros.h>

#include <exception>

#include "../ros/node.h"
#include "../ros/operator_publisher.h"

namespace {

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction simulated_operator_node [_PARAMETER:=VALUE]... [TOPIC:=OTHER]...

Does the trials of a running training_node: takes objects and training/status, and publishes a simulated operator's
hand on /leap_motion/leap_device.

  ~task    NAME|FILE; default pick_and_place
  ~group   beginner, veteran or none (undisturbed); default none
  ~seed    default 1
  ~noise   1: as a Leap's; default 1
  ~rate    frames per second; default 115
)";

}  // namespace

int main(int argc, char** argv) {
  if (const auto status = mrhi::status_of_arguments(argc, argv, kUsage)) return *status;
  ros::init(argc, argv, "simulated_operator_node");
  mrhi::end_in_order();
  const ros::NodeHandle node, parameters("~");  // outlive what may throw: without a node nothing is logged
  const mrhi::MasterWatch master;
  try {
    const mrhi::OperatorPublisher publisher(node, parameters);
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
