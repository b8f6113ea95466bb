#include "pose_array_hand.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/leap_human.h"

namespace mrhi {
namespace {

/// Of index to little; all have four of the thumb.
struct JointOrder {
  std::size_t joints, wrist, of_a_finger;
};
constexpr JointOrder kOrders[] = {{21, 0, 4}, {25, 0, 5}, {26, 1, 5}};

const JointOrder* order_of(std::size_t joints) {
  const auto found = std::find_if(std::begin(kOrders), std::end(kOrders),
                                  [=](const JointOrder& order) { return order.joints == joints; });
  return found == std::end(kOrders) ? nullptr : found;
}

std::optional<Vector3> joint(const geometry_msgs::Pose& pose) {
  const Vector3 position = from_message(pose.position);
  if (position.hasNaN()) return std::nullopt;
  return position;
}

void add_hand(const geometry_msgs::Pose* poses, const JointOrder& order, Side side, JointsFrame& frame) {
  if (std::none_of(poses, poses + order.joints, [](const auto& pose) { return joint(pose).has_value(); }))
    return;
  HandJoints hand;
  hand.id = 1u + static_cast<std::uint32_t>(side);
  hand.side = side;
  hand.wrist = joint(poses[order.wrist]);
  const geometry_msgs::Pose* next = poses + order.wrist + 1;
  for (std::size_t finger = 0; finger < kFingers; ++finger) {
    auto& joints = hand.joints[finger];
    for (std::size_t j = joints.size() - (finger == 0 ? 4 : order.of_a_finger); j < joints.size(); ++j)
      joints[j] = joint(*next++);
  }
  frame.hands.push_back(hand);
}

bool ends_with(const std::string& name, const std::string& end) {
  return name.size() >= end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

JointsFrame joints_from_pose_array(const geometry_msgs::PoseArray& message, Side side) {
  JointsFrame frame;
  frame.stamp = from_ros_time(message.header.stamp);
  const std::size_t joints = message.poses.size();
  if (joints == 0) return frame;
  if (const JointOrder* const order = order_of(joints)) {
    add_hand(message.poses.data(), *order, side, frame);
  } else if (has_both_hands(message)) {
    add_hand(message.poses.data(), *order_of(joints / 2), Side::left, frame);
    add_hand(message.poses.data() + joints / 2, *order_of(joints / 2), Side::right, frame);
  } else {
    throw DecodeError(
        DecodeError::Kind::wrong_count,
        "PoseArray has " + std::to_string(joints) +
            " joints; 21, 25 or 26 of a hand, twice as many of both, or none for a frame with no hand");
  }
  return frame;
}

bool has_both_hands(const geometry_msgs::PoseArray& message) {
  return message.poses.size() % 2 == 0 && order_of(message.poses.size()) == nullptr &&
         order_of(message.poses.size() / 2) != nullptr;
}

std::optional<Side> side_by_name(const std::string& name) {
  if (ends_with(name, "left_hand") || ends_with(name, "left/pose_array")) return Side::left;
  if (ends_with(name, "right_hand") || ends_with(name, "right/pose_array")) return Side::right;
  return std::nullopt;
}

}  // namespace mrhi
