#pragma once

#include "mr_hand_interaction/tracking/hand_skeleton.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi::testing {

/// A whole adult hand in a posture, its wrist at a pose: x to the fingers, z out of the back.
inline Hand posed_hand(const HandPosture& posture, const Pose& wrist, Side side = Side::right) {
  return complete_hand(hand_joints(human_hand(), side, wrist, posture), Pose());
}

}  // namespace mrhi::testing
