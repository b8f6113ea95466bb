#pragma once

#include <cmath>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// Shapes placed in world, as a search over directions sees them: `reach` is the support function h(n), the
/// extent from the centre along a unit n; `farthest` is where that is, relative to the centre.
struct OrientedBox {
  OrientedBox(const Box& box, const Pose& pose)
      : centre(pose.position), axes(pose.orientation.toRotationMatrix()), half(box.half_extents) {}

  double reach(const Vector3& n) const { return (axes.transpose() * n).cwiseAbs().dot(half); }
  Vector3 farthest(const Vector3& n) const {
    Vector3 local = axes.transpose() * n;
    for (int i = 0; i < 3; ++i) local[i] = local[i] < 0.0 ? -half[i] : half[i];
    return axes * local;
  }
  Vector3 corner(int bits) const {
    Vector3 local = half;
    for (int i = 0; i < 3; ++i) {
      if ((bits >> i & 1) == 0) local[i] = -local[i];
    }
    return centre + axes * local;
  }

  Vector3 centre;
  Matrix3 axes;
  Vector3 half;
};

struct OrientedCylinder {
  OrientedCylinder(const Cylinder& cylinder, const Pose& pose)
      : centre(pose.position),
        axes(pose.orientation.toRotationMatrix()),
        axis(axes.col(2)),
        radius(cylinder.radius),
        half_length(cylinder.half_length) {}

  Vector3 across(const Vector3& n) const { return n - axis.dot(n) * axis; }
  double reach(const Vector3& n) const {
    return radius * across(n).norm() + half_length * std::abs(axis.dot(n));
  }
  Vector3 farthest(const Vector3& n) const {
    const Vector3 level = across(n);
    const double length = level.norm();
    const double end = axis.dot(n) < 0.0 ? -half_length : half_length;
    return (length > 0.0 ? radius / length : 0.0) * level + end * axis;
  }

  Vector3 centre;
  Matrix3 axes;
  Vector3 axis;
  double radius, half_length;
};

/// Second derivatives of the support functions on the sphere of directions: a box has corners, a rim bends.
inline Matrix3 bend(const OrientedBox&, const Vector3&) {
  return Matrix3::Zero();
}
inline Matrix3 bend(const OrientedCylinder& cylinder, const Vector3& n) {
  const Vector3 tangent = cylinder.axis.cross(n);
  const double squared = tangent.squaredNorm();
  if (squared < 1e-24) return Matrix3::Zero();
  return cylinder.radius / (squared * std::sqrt(squared)) * tangent * tangent.transpose();
}

}  // namespace mrhi
