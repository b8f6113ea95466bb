#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <cstdint>

namespace mrhi {

using Vector3 = Eigen::Vector3d;
using Matrix3 = Eigen::Matrix3d;
using Quaternion = Eigen::Quaterniond;

/// Stamps and durations [ns]. Time is input: the core reads no clock.
using Nanoseconds = std::int64_t;
inline double to_seconds(Nanoseconds time) {
  return 1e-9 * static_cast<double>(time);
}
inline Nanoseconds to_nanoseconds(double seconds) {
  return static_cast<Nanoseconds>(std::llround(1e9 * seconds));
}

/// Rigid transform; maps a point of the local frame to the parent frame.
struct Pose {
  Vector3 position = Vector3::Zero();               ///< [m]
  Quaternion orientation = Quaternion::Identity();  ///< unit

  Vector3 operator*(const Vector3& point) const { return orientation * point + position; }
  Pose operator*(const Pose& local) const {
    return {*this * local.position, orientation * local.orientation};
  }
  /// Maps a point of the parent frame to the local frame.
  Vector3 to_local(const Vector3& point) const { return orientation.conjugate() * (point - position); }
  Pose inverse() const { return {-(orientation.conjugate() * position), orientation.conjugate()}; }
};

/// Velocity of a body: linear of its centre of mass [m/s], angular [rad/s]; world axes.
struct Twist {
  Vector3 linear = Vector3::Zero();
  Vector3 angular = Vector3::Zero();
};

/// [v]x, so that [v]x w = v x w.
inline Matrix3 cross_matrix(const Vector3& v) {
  Matrix3 m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// All points within `radius` of the segment start..end [m]. Radius 0 means absent.
struct Capsule {
  Vector3 start = Vector3::Zero();
  Vector3 end = Vector3::Zero();
  double radius = 0.0;

  /// Point of the axis at s in 0..1.
  Vector3 axis_point(double s) const { return start + s * (end - start); }
  Vector3 centre() const { return 0.5 * (start + end); }
};

}  // namespace mrhi
