#include <ros/ros.h>

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
  const auto body = [](const ros::NodeHandle& node, const ros::NodeHandle& private_node) {
    const mrhi::HandMerging merging(node, private_node);
    ros::spin();
  };
  return mrhi::run_node(argc, argv, "merge_hands", kUsage, body);
}
