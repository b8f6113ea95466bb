#pragma once

#include <Eigen/Core>
#include <array>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// By how much a finger's joints are turned away from where they were tracked: flexion (towards the palm) and
/// abduction (towards the thumb of a right hand) of its root, flexion of its middle and end joint [rad]. Of a
/// finger without a proximal phalanx, which nothing ties to the palm: its shift in world [m], and 0.
using FingerOffset = Eigen::Array4d;

/// How a rendered hand differs from the tracked one. Lasts from frame to frame.
struct HandOffset {
  Vector3 shift = Vector3::Zero();  ///< of the whole hand in world [m]
  std::array<FingerOffset, kFingers> fingers;
  Nanoseconds stamp = 0;  ///< of the frame that it was found for

  // While a body holds the hand back though the tracked hand is clear of all:
  double left = 0.0;           ///< the shortest way to the tracked hand so far [m]; 0: it is not held back
  Nanoseconds left_since = 0;  ///< when that was

  HandOffset() { fingers.fill(FingerOffset::Zero()); }
  bool zero() const;
};

}  // namespace mrhi
