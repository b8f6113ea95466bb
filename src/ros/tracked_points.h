#pragma once

#include <std_msgs/Header.h>

#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "../tracking/joint_orders.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// What a tracker's message says: joints of one hand or both, in one of joint_orders(), in the header's
/// frame.
struct TrackedPoints {
  std_msgs::Header header;
  std::vector<Vector3> points;
  std::vector<float> radii;  ///< of the points, from the joint to the skin; empty: not known
  float confidence = 1.0f;   ///< 0 to 1
};

/// Hands that a tracker's message has by name of finger and bone, in the header's frame.
struct TrackedHands {
  std_msgs::Header header;
  std::vector<HandJoints> hands;
  bool tells_sides = false;  ///< else there is one hand, of the side that topic or frame names
};

using TrackerMessage = std::variant<TrackedPoints, TrackedHands>;

/// A header of a message with another allocator.
template <class Header>
std_msgs::Header header_of(const Header& other) {
  std_msgs::Header header;
  header.seq = other.seq;
  header.stamp = other.stamp;
  header.frame_id.assign(other.frame_id.begin(), other.frame_id.end());
  return header;
}

/// The order of a hand's joints, of so many.
using OrderOf = std::function<const JointOrder&(std::size_t size, const Vector3* points)>;

/// Hands from the joints' positions; a joint of which a coordinate is NaN is missing. Twice as many joints as
/// an order has: a left hand, then a right one; else the hand is of the side given. A hand without any joint
/// is not there; no points: a frame with no hand. Ids are 1 for left, 2 for right, as such trackers give
/// none. Without `order_of` it is the usual order of that size. Throws DecodeError for any other number of
/// joints.
JointsFrame joints_from_points(const TrackedPoints& tracked, Side side, const OrderOf& order_of = {});

/// Topics of one hand or both, of the left hand, of the right.
inline std::vector<std::string> hands_topics(const std::string& end) {
  return {"hands/" + end, "hands/left/" + end, "hands/right/" + end};
}

/// Whether it has both hands.
bool has_both_hands(const TrackedPoints& tracked);

/// The side that a topic names by its last part or the one before, as hands/left/pose_array does.
std::optional<Side> side_of_topic(const std::string& name);
/// The side that a frame names, which ends in left_hand or right_hand.
std::optional<Side> side_of_frame(const std::string& name);

}  // namespace mrhi
