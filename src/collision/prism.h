#pragma once

#include <cmath>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// A form placed in world, as a search over directions sees it: `reach` is the support function h(n), the
/// extent from the centre along a unit n; `farthest` is where that is, relative to the centre. Symmetric
/// about its centre.
struct Prism {
  Prism(const PrismForm& form, const Pose& pose)
      : centre(pose.position),
        axes(pose.orientation.toRotationMatrix()),
        half(form.half),
        round(form.round) {}

  /// Axes from here to 2 have flat faces at their ends, and straight lines on the surface along them. A
  /// disc's two axes across are of no account: only z remains.
  int first_flat() const { return round ? 2 : 0; }
  Vector3 axis() const { return axes.col(2); }
  Vector3 across(const Vector3& n) const { return n - axes.col(2).dot(n) * axes.col(2); }

  double reach(const Vector3& n) const { return reach_along(axes.transpose() * n); }
  /// The same for a direction in its own axes.
  ///     box:       h(n) = sum |n_i| half_i
  ///     cylinder:  h(n) = r sqrt(n_x^2 + n_y^2) + half_z |n_z|
  double reach_along(const Vector3& local) const {
    if (!round) return local.cwiseAbs().dot(half);
    return half.x() * local.head<2>().norm() + half.z() * std::abs(local.z());
  }
  /// The gradient of h: h(n) = n.farthest(n). Where it is not unique (n along a face, or along a disc's axis)
  /// it is the corner on the positive sides, or the cap's middle: always the same, not always the middle of
  /// what is level.
  Vector3 farthest(const Vector3& n) const {
    const Vector3 local = axes.transpose() * n;
    Vector3 place = (local.array() < 0.0).select(-half, half);
    if (round) {
      const double level = local.head<2>().norm();
      place.head<2>() = (level > 0.0 ? half.x() / level : 0.0) * local.head<2>();
    }
    return axes * place;
  }
  /// Second derivatives of h on the sphere of directions: a rim bends, corners do not. With h taken as
  /// homogeneous of degree 1 and t = axis x n, |t| = sqrt(n_x^2 + n_y^2), that of a rim is (r / |t|) (t/|t|)
  /// (t/|t|)^T: it turns about the axis alone. Along the axis t is 0 and the rim as a whole is farthest: h
  /// has a kink there and no second derivative; zero stands for it, and try_flats has looked.
  Matrix3 bend(const Vector3& n) const {
    if (!round) return Matrix3::Zero();
    const Vector3 tangent = axis().cross(n);
    const double squared = tangent.squaredNorm();
    if (squared < 1e-24) return Matrix3::Zero();
    return half.x() / (squared * std::sqrt(squared)) * tangent * tangent.transpose();
  }
  /// Of one on a rectangle: bit i is set on the positive side of axis i.
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
  bool round;
};

}  // namespace mrhi
