#include <ros/ros.h>

#include <exception>

#include "../ros/hand_merging.h"
#include "../ros/node.h"

namespace {

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction merge_hands _inputs:="[TOPIC, TOPIC, ...]" [_mode:=people|fused]

Merges the hand_frame topics of several hand_tracking_nodes into one, hand_frame. Their stamps must be of one clock, and
their hands in one frame.

  ~inputs   topics of HandFrame, 2 to 8
  ~mode     people (default): each topic has hands of its own, as of two people
            fused: all topics have the hands of one person; of each side one hand comes, by the trackers' confidence
)";

}  // namespace

int main(int argc, char** argv) {
  if (const auto status = mrhi::status_of_arguments(argc, argv, kUsage)) return *status;
  ros::init(argc, argv, "merge_hands");
  mrhi::end_in_order();
  const ros::NodeHandle private_node("~");  // outlives what may throw: without a node nothing is logged
  const mrhi::MasterWatch master;
  try {
    const mrhi::HandMerging merging(ros::NodeHandle(), private_node);
    ros::spin();
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return 1;
  }
  return 0;
}
