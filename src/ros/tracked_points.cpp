#include "tracked_points.h"

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

std::optional<Vector3> joint(const Vector3& point) {
  if (point.hasNaN()) return std::nullopt;
  return point;
}

void add_hand(const Vector3* points, const JointOrder& order, Side side, JointsFrame& frame) {
  if (std::all_of(points, points + order.joints, [](const Vector3& point) { return point.hasNaN(); })) return;
  HandJoints hand;
  hand.id = 1u + static_cast<std::uint32_t>(side);
  hand.side = side;
  hand.wrist = joint(points[order.wrist]);
  const Vector3* next = points + order.wrist + 1;
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

JointsFrame joints_from_points(const TrackedPoints& tracked, Side side) {
  JointsFrame frame;
  frame.stamp = from_ros_time(tracked.header.stamp);
  const Vector3* const points = tracked.points.data();
  const std::size_t joints = tracked.points.size();
  if (joints == 0) return frame;
  if (const JointOrder* const order = order_of(joints)) {
    add_hand(points, *order, side, frame);
  } else if (has_both_hands(tracked)) {
    add_hand(points, *order_of(joints / 2), Side::left, frame);
    add_hand(points + joints / 2, *order_of(joints / 2), Side::right, frame);
  } else {
    throw DecodeError(
        DecodeError::Kind::wrong_count,
        std::to_string(joints) +
            " joints; 21, 25 or 26 of a hand, twice as many of both, or none for a frame with no hand");
  }
  return frame;
}

bool has_both_hands(const TrackedPoints& tracked) {
  const std::size_t joints = tracked.points.size();
  return joints % 2 == 0 && order_of(joints) == nullptr && order_of(joints / 2) != nullptr;
}

std::optional<Side> side_of_topic(const std::string& name) {
  const std::size_t slash = name.rfind('/');
  const std::string folder = "/" + name.substr(0, slash == std::string::npos ? 0 : slash);
  if (ends_with(folder, "/left")) return Side::left;
  if (ends_with(folder, "/right")) return Side::right;
  return std::nullopt;
}

std::optional<Side> side_of_frame(const std::string& name) {
  if (ends_with(name, "left_hand")) return Side::left;
  if (ends_with(name, "right_hand")) return Side::right;
  return std::nullopt;
}

}  // namespace mrhi
