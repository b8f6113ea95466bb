#pragma once

#include <cmath>

#include "mr_hand_interaction/math.h"

namespace mrhi {

constexpr double kDegree = M_PI / 180.0;  ///< [rad]

/// Rotation by |vector| [rad] about the vector.
inline Quaternion rotation_by(const Vector3& vector) {
  const double angle = vector.norm();
  if (angle == 0.0) return Quaternion::Identity();
  return Quaternion(Eigen::AngleAxisd(angle, vector / angle));
}

/// Inverse of rotation_by(): the shorter rotation.
inline Vector3 rotation_vector(const Quaternion& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

/// Matrix of a rotation about a unit axis [rad].
inline Matrix3 turn_about(const Vector3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

}  // namespace mrhi
