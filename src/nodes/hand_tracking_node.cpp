#include "../ros/network_thread.h"
#include "../ros/node.h"
#include "mr_hand_interaction/ros/hand_tracking.h"

constexpr const char* kUsage =
    R"(usage: rosrun mr_hand_interaction hand_tracking_node [_PARAMETER:=VALUE]... [TOPIC:=OTHER]...

Subscribes to hand trackers, and publishes their hands in the world frame on hand_frame.

  /leap_motion/leap_device                      leap_motion/Human, any published version
  /leapmotion/hands/left, /leapmotion/hands/right
                                                leap_motion_controller/Hand
  hands/pose_array, hands/left/pose_array, hands/right/pose_array
                                                geometry_msgs/PoseArray of 21, 24, 25 or 26 joints; see docs/trackers.md
  hands/point_cloud, hands/left/point_cloud, hands/right/point_cloud
                                                sensor_msgs/PointCloud of the same joints, with channels radius and confidence
  Each topic accepts each of these message types.
  ~fixed_frame   frame into which tf transforms the hands; default world
  ~side          side of a hand on hands/pose_array or hands/point_cloud: left or right; default right
  ~order         order of the joints, a name of docs/trackers.md; default none: recognised by the bone lengths
  ~scale         metres per unit of the tracker; default 1
)";

int main(int argc, char** argv) {
  mrhi::NetworkThreadQueue queue;  // before the first node handle
  const auto body = [&queue](const auto& node, const auto& private_node) {
    const mrhi::HandTracking tracking(queue.handle(node), queue.handle(private_node));
    queue.spin();
  };
  return mrhi::run_node(argc, argv, "hand_tracking_node", kUsage, body);
}
