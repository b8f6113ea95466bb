#pragma once

#include <algorithm>
#include <array>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// A bone for the skin to follow: x along it, z to the back of the hand, y = z x x (mirrored: x x z).
struct SkinBone {
  Vector3 start = Vector3::Zero();
  Matrix3 axes = Matrix3::Identity();  ///< columns; of a left hand, y is negated
  double length = 0.0;                 ///< [m]
  double radius = 0.0;                 ///< [m]
};

constexpr int kBendsPerFinger = kBonesPerFinger - 1;
constexpr int kFirstBend = kPhalanges;
constexpr int kWristBone = kFirstBend + kFingers * kBendsPerFinger;
constexpr int kSkinBones = kWristBone + 1;

/// The bone half-way between two phalanges, at the joint where phalanx `bone` begins; bone is 1 to 3.
constexpr int bend_index(int finger, int bone) {
  return kFirstBend + finger * kBendsPerFinger + bone - 1;
}

/// The thumb's metacarpal is not in the palm.
constexpr int first_bone(int finger) {
  return finger == 0 ? 1 : 0;
}

/// The hand's phalanges, the bends between them, and the wrist.
using SkinRig = std::array<SkinBone, kSkinBones>;

/// The right hand that the skin is modelled on: stretched, fingers spread, in the frame of HandSkeleton.
struct RestHand {
  Hand hand;
  SkinRig rig;
};
const RestHand& rest_hand();

/// Whether no bone is missing but the thumb's metacarpal.
bool has_whole_skin(const Hand& hand);

/// Bones turn from where the rest hand has them by the least rotation that each takes from the one before.
/// The hand must have a whole skin.
SkinRig pose_rig(const Hand& hand);

/// 0 at `from`, 1 at `to`, constant beyond, with no kink; `from` may be the greater. t^2 (3 - 2 t): its slope
/// is 0 at both ends.
inline double smooth_step(double from, double to, double x) {
  const double t = std::min(1.0, std::max(0.0, (x - from) / (to - from)));
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace mrhi
