#include "tracked_points.h"

#include <algorithm>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/leap_human.h"

namespace mrhi {
namespace {

bool has_size(std::size_t joints) {
  const auto& orders = joint_orders();
  return std::any_of(orders.begin(), orders.end(),
                     [=](const JointOrder& order) { return order.size == joints; });
}

const JointOrder& usual_order(std::size_t joints, const Vector3*) {
  const auto& orders = joint_orders();
  return *std::find_if(orders.begin(), orders.end(),
                       [=](const JointOrder& order) { return order.size == joints; });
}

void add_hand(const TrackedPoints& tracked, std::size_t first, std::size_t joints, Side side,
              const OrderOf& order_of, JointsFrame& frame) {
  const Vector3* const points = tracked.points.data() + first;
  if (std::all_of(points, points + joints, [](const Vector3& point) { return point.hasNaN(); })) return;
  const bool has_radii = tracked.radii.size() == tracked.points.size();
  frame.hands.push_back(hand_in_order(order_of(joints, points), points,
                                      has_radii ? tracked.radii.data() + first : nullptr, side));
  frame.hands.back().confidence = tracked.confidence;
}

bool ends_with(const std::string& name, const std::string& end) {
  return name.size() >= end.size() && name.compare(name.size() - end.size(), end.size(), end) == 0;
}

}  // namespace

JointsFrame joints_from_points(const TrackedPoints& tracked, Side side, const OrderOf& order_of) {
  JointsFrame frame;
  frame.stamp = from_ros_time(tracked.header.stamp);
  const std::size_t joints = tracked.points.size();
  const OrderOf& order = order_of ? order_of : OrderOf(usual_order);
  if (joints == 0) return frame;
  if (has_size(joints)) {
    add_hand(tracked, 0, joints, side, order, frame);
  } else if (has_both_hands(tracked)) {
    add_hand(tracked, 0, joints / 2, Side::left, order, frame);
    add_hand(tracked, joints / 2, joints / 2, Side::right, order, frame);
  } else {
    throw DecodeError(
        DecodeError::Kind::wrong_count,
        std::to_string(joints) +
            " joints; 21, 24, 25 or 26 of a hand, twice as many of both, or none for a frame with no hand");
  }
  return frame;
}

bool has_both_hands(const TrackedPoints& tracked) {
  const std::size_t joints = tracked.points.size();
  return joints % 2 == 0 && !has_size(joints) && has_size(joints / 2);
}

std::optional<Side> side_of_topic(const std::string& name) {
  std::string rest = "/" + name;
  for (int part = 0; part < 2; ++part) {
    if (ends_with(rest, "/left")) return Side::left;
    if (ends_with(rest, "/right")) return Side::right;
    rest.erase(rest.rfind('/') == std::string::npos ? 0 : rest.rfind('/'));
  }
  return std::nullopt;
}

std::optional<Side> side_of_frame(const std::string& name) {
  if (ends_with(name, "left_hand")) return Side::left;
  if (ends_with(name, "right_hand")) return Side::right;
  return std::nullopt;
}

}  // namespace mrhi
