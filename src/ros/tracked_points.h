#pragma once

#include <std_msgs/Header.h>

#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// What a tracker's message says: joints of one hand or both in one of the orders below, in the header's
/// frame [m].
struct TrackedPoints {
  std_msgs::Header header;
  std::vector<Vector3> points;
};

/// Hands from the joints' positions, by how many there are; a joint of which a coordinate is NaN is missing.
///   21, as MediaPipe has them: wrist; thumb CMC, MCP, IP, tip; index, middle, ring, little each MCP, PIP,
///   DIP, tip 25, as WebXR: the same, but each finger from the base of its metacarpal on 26, as OpenXR: the
///   palm, which is not used, and then as WebXR
/// Twice as many: a left hand, then a right one; else the hand is of the side given. A hand without any joint
/// is not there; no points: a frame with no hand. Ids are 1 for left, 2 for right, as such trackers give
/// none. Throws DecodeError for any other number of joints.
JointsFrame joints_from_points(const TrackedPoints& tracked, Side side);

/// Whether it has both hands.
bool has_both_hands(const TrackedPoints& tracked);

/// The side that a topic names, as hands/left/pose_array does by its last part but one.
std::optional<Side> side_of_topic(const std::string& name);
/// The side that a frame names, which ends in left_hand or right_hand.
std::optional<Side> side_of_frame(const std::string& name);

}  // namespace mrhi
