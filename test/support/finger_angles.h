#pragma once

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/rendering/rendered_hand.h"
#include "rendering/renderer.h"

namespace mrhi::testing {

inline Vector3 bone_direction(const Hand& hand, int finger, int bone) {
  const Capsule& capsule = hand.capsules[static_cast<std::size_t>(capsule_index(finger, bone))];
  return (capsule.end - capsule.start).normalized();
}

/// Angles of a finger's joints as one reads them off a hand: the proximal phalanx against the metacarpal and
/// the palm's back (a thumb's metacarpal against its rest pose), then from bone to bone: of a finger about
/// its own cross axis, of a thumb, whose axis the joints do not tell, altogether [rad]. Of a finger that
/// lacks a phalanx: zero.
inline FingerOffset finger_angles(const Hand& hand, int finger) {
  FingerOffset angles = FingerOffset::Zero();
  for (int bone = 1; bone < kBonesPerFinger; ++bone)
    if (!hand.has(capsule_index(finger, bone))) return angles;
  const Matrix3 palm = hand.palm.orientation.toRotationMatrix();
  Vector3 along = palm.col(0), across = palm.col(1);
  if (finger == 0) {
    const double side = hand.side == Side::left ? -1.0 : 1.0;
    const Vector3 mirror(1.0, side, 1.0);
    along = palm * thumb_rest().along.cwiseProduct(mirror);
    across = palm * (side * thumb_rest().hinge).cwiseProduct(mirror);
  } else if (hand.has(capsule_index(finger, 0))) {
    along = bone_direction(hand, finger, 0);
    across = palm.col(2).cross(along).normalized();
  }
  const Vector3 proximal = bone_direction(hand, finger, 1), middle = bone_direction(hand, finger, 2),
                distal = bone_direction(hand, finger, 3);
  angles[0] = std::atan2(-proximal.dot(along.cross(across)), proximal.dot(along));
  angles[1] = std::asin(std::clamp(proximal.dot(across), -1.0, 1.0));
  const Vector3 hinge = proximal.cross(across).normalized().cross(proximal);
  const auto bend = [&](const Vector3& from, const Vector3& to) {
    const Vector3 cross = from.cross(to);
    return std::atan2(finger == 0 ? cross.norm() : cross.dot(hinge), from.dot(to));
  };
  angles[2] = bend(proximal, middle);
  angles[3] = bend(middle, distal);
  return angles;
}

/// By how much the angles of a finger of `shown` are beyond their limits and beyond those of `tracked` [rad].
inline double beyond_limits(const Hand& tracked, const Hand& shown, int finger) {
  const JointLimits limits = joint_limits(finger);
  const FingerOffset from = finger_angles(tracked, finger), to = finger_angles(shown, finger);
  const double above = (to - limits.upper.max(from)).maxCoeff();
  const double below = (limits.lower.min(from) - to).maxCoeff();
  return std::max({0.0, above, below});
}

}  // namespace mrhi::testing
