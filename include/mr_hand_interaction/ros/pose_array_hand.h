#pragma once

#include <geometry_msgs/PoseArray.h>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// One hand from 21 joints in the order of MediaPipe: wrist; thumb CMC, MCP, IP, tip; index, middle, ring and
/// little each MCP, PIP, DIP, tip [m]. No poses: a frame with no hand. Orientations are not used. The hand's
/// id is 1 for left, 2 for right, as such trackers give none. Throws DecodeError for any other number of
/// joints.
JointsFrame joints_from_pose_array(const geometry_msgs::PoseArray& message, Side side);

}  // namespace mrhi
