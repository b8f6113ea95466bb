#pragma once

#include "support/grips.h"

namespace mrhi::testing {

constexpr double kReachedHalf = 0.02;  // of the cube [m]
constexpr double kFingersAway = 0.04;  // of the tips' surfaces from the cube's middle as the hand is open [m]

/// Thumb and index reach for a cube from its two sides; at `closed` 1 each is `deep` in it, the index ahead
/// by `ahead`: a hand that feels nothing.
inline Hand reaching(double closed, double deep, double ahead, const Vector3& shift = Vector3::Zero()) {
  Hand hand = empty_hand();
  const double in = kFingersAway - closed * (kFingersAway - kReachedHalf + deep);
  add_fingertip(hand, capsule_index(1, 3), Vector3(in - ahead, 0, 0), Vector3::UnitX(), 1.2);
  add_fingertip(hand, capsule_index(0, 3), Vector3(-in - ahead, 0, 0), -Vector3::UnitX(), 1.2);
  Pose pose;
  pose.position = shift;
  return moved(hand, pose);
}

}  // namespace mrhi::testing
