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

/// Shortest rotation from the direction of one vector to that of another; about any perpendicular axis if
/// they are opposite. Eigen's FromTwoVectors() takes an SVD for these, which costs seconds in each file to
/// compile.
inline Quaternion rotation_between(const Vector3& from, const Vector3& to) {
  const Vector3 a = from.normalized(), b = to.normalized();
  const double cosine = b.dot(a);
  if (cosine < -1.0 + 1e-12) {
    const Vector3 axis = a.unitOrthogonal();
    return Quaternion(0.0, axis.x(), axis.y(), axis.z());
  }
  const Vector3 axis = a.cross(b);
  const double s = std::sqrt((1.0 + cosine) * 2.0), inverse = 1.0 / s;
  return Quaternion(s * 0.5, axis.x() * inverse, axis.y() * inverse, axis.z() * inverse);
}

/// Matrix of a rotation about a unit axis [rad].
inline Matrix3 turn_about(const Vector3& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

}  // namespace mrhi
