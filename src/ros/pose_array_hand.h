#pragma once

#include <geometry_msgs/PoseArray.h>

#include <optional>
#include <string>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Hands from the joints' positions [m], by how many there are; orientations are not used, and a joint of
/// which a coordinate is NaN is missing.
///   21, as MediaPipe has them: wrist; thumb CMC, MCP, IP, tip; index, middle, ring, little each MCP, PIP,
///   DIP, tip 25, as WebXR: the same, but each finger from the base of its metacarpal on 26, as OpenXR: the
///   palm, which is not used, and then as WebXR
/// Twice as many: a left hand, then a right one; else the hand is of the side given. A hand without any joint
/// is not there; no poses: a frame with no hand. Ids are 1 for left, 2 for right, as such trackers give none.
/// Throws DecodeError for any other number of joints.
JointsFrame joints_from_pose_array(const geometry_msgs::PoseArray& message, Side side);

/// Whether it has both hands.
bool has_both_hands(const geometry_msgs::PoseArray& message);

/// By a name that ends in left_hand or right_hand, as a frame's may, or in left/pose_array or
/// right/pose_array, as a topic's may.
std::optional<Side> side_by_name(const std::string& name);

}  // namespace mrhi
