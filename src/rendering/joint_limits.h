#pragma once

#include "mr_hand_interaction/rendering/hand_offset.h"

namespace mrhi {

/// How far joints go, active and passive, rounded outwards to 5 degrees: Kapandji, The Physiology of the
/// Joints, vol. 1; Norkin & White, Measurement of Joint Motion [rad]. Order as in FingerOffset.
struct JointLimits {
  FingerOffset lower, upper;
};

/// Of the thumb: its carpometacarpal joint against a rest pose, then metacarpophalangeal and interphalangeal.
JointLimits joint_limits(int finger);

/// Rest pose of the thumb's metacarpal in the palm of a right hand (x to the fingers, z out of the back):
/// where it points, and the axis about which the thumb flexes. Unit, at right angles.
struct ThumbRest {
  Vector3 along, hinge;
};
const ThumbRest& thumb_rest();

}  // namespace mrhi
