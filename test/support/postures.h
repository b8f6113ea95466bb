#pragma once

#include "mr_hand_interaction/tracking/hand_skeleton.h"

namespace mrhi::testing {

/// A closed fist, the thumb across the fingers.
inline HandPosture fist_posture() {
  HandPosture p;
  p << 30, 0, 0, 0, 0,         //
      25, 80, 82, 84, 86,      //
      40, 100, 102, 102, 100,  //
      50, 65, 65, 65, 65,      //
      45, 0, 0, 0, 0;
  return M_PI / 180.0 * p;
}

/// Stretched, fingers spread.
inline HandPosture open_posture() {
  HandPosture p = HandPosture::Zero();
  p.row(kAbduction) << 10, 8, 1, -6, -12;
  return M_PI / 180.0 * p;
}

/// The synthetic hand in this posture, its wrist at the origin.
inline Hand hand_in(const HandPosture& posture, Side side = Side::right) {
  return complete_hand(hand_joints(human_hand(), side, Pose{}, posture), Pose{});
}

}  // namespace mrhi::testing
