#pragma once

#include <cmath>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// A flat open hand, palm down at the origin, fingers along x, back of the hand up: nothing left out but the
/// thumb's metacarpal (length zero, as Leap gives it).
inline HandJoints adult_hand(Side side) {
  const double y_sign = side == Side::right ? 1.0 : -1.0;
  HandJoints hand;
  hand.id = 7;
  hand.side = side;
  hand.palm_centre = Vector3(0.0, 0.0, 0.0);
  hand.palm_width = 0.084f;
  hand.wrist = Vector3(-0.065, -0.006 * y_sign, 0.003);
  const double base[4][3] = {{-43, 12, 12}, {-41, 1, 13}, {-40, -10, 12}, {-42, -21, 6}};
  const double knuckle[4][3] = {{23, 23, 2}, {23, 3, 4}, {17, -17, 4}, {10, -35, 0}};
  const double lengths[4][3] = {{40, 22, 16}, {45, 26, 17}, {41, 26, 17}, {33, 18, 16}};
  for (std::size_t f = 0; f < 4; ++f) {
    auto& joints = hand.joints[f + 1];
    joints[0] = 1e-3 * Vector3(base[f][0], y_sign * base[f][1], base[f][2]);
    joints[1] = 1e-3 * Vector3(knuckle[f][0], y_sign * knuckle[f][1], knuckle[f][2]);
    for (std::size_t b = 0; b < 3; ++b)
      joints[b + 2] = joints[b + 1].value() + 1e-3 * lengths[f][b] * Vector3::UnitX();
    hand.finger_width[f + 1] = 0.018f;
  }
  const double thumb[5][3] = {{-53, 19, -6}, {-53, 19, -6}, {-20, 50, -10}, {5, 68, -12}, {22, 80, -14}};
  for (std::size_t j = 0; j < 5; ++j)
    hand.joints[0][j] = 1e-3 * Vector3(thumb[j][0], y_sign * thumb[j][1], thumb[j][2]);
  hand.finger_width[0] = 0.020f;
  return hand;
}

inline bool finite(const Hand& hand) {
  bool all =
      hand.palm.position.allFinite() && hand.palm.orientation.coeffs().allFinite() && hand.wrist.allFinite();
  for (const Capsule& capsule : hand.capsules)
    all = all && capsule.start.allFinite() && capsule.end.allFinite() && std::isfinite(capsule.radius);
  return all;
}

}  // namespace mrhi
