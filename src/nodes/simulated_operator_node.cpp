#include <ros/ros.h>

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
  const auto body = [](const ros::NodeHandle& node, const ros::NodeHandle& private_node) {
    const mrhi::OperatorPublisher publisher(node, private_node);
    ros::spin();
  };
  return mrhi::run_node(argc, argv, "simulated_operator_node", kUsage, body);
}
