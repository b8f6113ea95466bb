#include "mr_hand_interaction/ros/pose_array_hand.h"

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/leap_human.h"

namespace mrhi {

JointsFrame joints_from_pose_array(const geometry_msgs::PoseArray& message, Side side) {
  constexpr std::size_t kJoints = 21, kJointsPerFinger = 4;
  JointsFrame frame;
  frame.stamp = from_ros_time(message.header.stamp);
  if (message.poses.empty()) return frame;
  if (message.poses.size() != kJoints)
    throw DecodeError(DecodeError::Kind::wrong_count, "PoseArray has " +
                                                          std::to_string(message.poses.size()) +
                                                          " joints; 21, or none for a frame with no hand");
  HandJoints hand;
  hand.id = 1u + static_cast<std::uint32_t>(side);
  hand.side = side;
  hand.wrist = from_message(message.poses[0].position);
  for (std::size_t i = 1; i < kJoints; ++i)
    hand.joints[(i - 1) / kJointsPerFinger][(i - 1) % kJointsPerFinger + 1] =
        from_message(message.poses[i].position);
  frame.hands.push_back(hand);
  return frame;
}

}  // namespace mrhi
