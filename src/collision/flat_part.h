#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "closest_features.h"
#include "mr_hand_interaction/math.h"
#include "segment.h"

namespace mrhi {

/// The part of the line x + t * dx that is inside a shape. Of a convex shape that is one interval in..out,
/// the common part of those of its slabs and balls (Kay & Kajiya 1986; Ericson, Real-Time Collision
/// Detection, 5.3.3); it is empty where out < in.
class Chord {
 public:
  /// Keeps |x + t dx| <= half: t between (-half - x) / dx and (half - x) / dx, in whatever order. A level
  /// line is in or out as a whole; by the quotients it would be 0 / 0 along a side.
  void clip_to_slab(double x, double dx, double half) {
    if (std::abs(dx) < kMaxLevelComponent) {
      if (std::abs(x) > half + kBorderTolerance) out_ = -std::numeric_limits<double>::infinity();
      return;
    }
    const double a = (-half - x) / dx, b = (half - x) / dx;
    clip(std::min(a, b), std::max(a, b));
  }
  /// Keeps what is within `radius` of the origin, in as many dimensions as the line is given in.
  template <class Vector>
  /// t = f -+ sqrt(r^2 - m^2) / |dx| about the foot f = -x.dx / dx^2, which is m off the origin.
  void clip_to_ball(const Vector& x, const Vector& dx, double radius) {
    const double length = dx.norm();
    if (length < kMaxLevelComponent) {
      if (x.norm() > radius + kBorderTolerance) out_ = -std::numeric_limits<double>::infinity();
      return;
    }
    const double nearest = -x.dot(dx) / (length * length);
    const double miss = (x + nearest * dx).norm();
    if (miss > radius + kBorderTolerance) out_ = -std::numeric_limits<double>::infinity();
    const double half = std::sqrt(std::max(0.0, radius * radius - miss * miss)) / length;
    clip(nearest - half, nearest + half);
  }
  /// Parameter at which the line leaves the shape; nothing if it misses.
  std::optional<double> out() const { return out_ < in_ ? std::nullopt : std::optional<double>(out_); }

 private:
  /// Largest distance from a side at which a line along it still meets the shape [m].
  static constexpr double kBorderTolerance = 1e-9;
  /// Largest component of a direction that is rounding.
  static constexpr double kMaxLevelComponent = 1e-12;

  void clip(double from, double to) { in_ = std::max(in_, from), out_ = std::min(out_, to); }

  double in_ = -std::numeric_limits<double>::infinity(), out_ = -in_;
};

/// Largest angle between equal normals [rad].
constexpr double kSameNormal = 1e-6;

inline AxisSpan at_point(const ClosestFeatures& features) {
  return {features.axis_parameter, features.axis_parameter};
}
inline AxisSpan at_edge(const ClosestFeatures& features) {
  return {features.axis_parameter, features.axis_parameter, true};
}
/// Part of the axis over the surface whose normal the features have, at least the features' point: rounding
/// must not put the deepest point outside.
inline AxisSpan over(const Interval& stretch, const ClosestFeatures& features) {
  if (stretch.s0 >= stretch.s1) return at_point(features);
  return {std::min(std::max(stretch.s0, 0.0), features.axis_parameter),
          std::max(std::min(stretch.s1, 1.0), features.axis_parameter)};
}

/// Beside the round side of a shape that is straight along z, from -half to half: the line of touch shrinks
/// to a point while the capsule turns across the side. |(z x n).a| / |a| = sin psi tells by which angle the
/// axis a is turned across the side with the normal n. The span is (1 - sin psi / 0.3) of what stands beside
/// the side, about s: continuous in psi, where a switch from two points to one would throw what friction has
/// stored from one to the other. Capsules of radii r, R that are pressed together by d touch over
/// sqrt(2 d (r + R)) / psi to both sides, which is half a phalanx at some 0.5 rad. With 0.1 in
/// place of 0.3 a small turn moved the load so far along a phalanx that held rods crept by up to 20 um/s.
inline AxisSpan beside_round_side(const Segment& axis, const ClosestFeatures& features, double half) {
  constexpr double kMinCrossingAngle = 0.3;  // touches at a point [rad]
  Interval stretch;
  stretch.clip_to_slab(axis.start.z(), axis.along.z(), half);
  const AxisSpan beside = over(stretch, features);
  const double across = std::abs(Vector3::UnitZ().cross(features.normal).dot(axis.along));
  const double part = std::max(0.0, 1.0 - across / (kMinCrossingAngle * axis.along.norm()));
  const double s = features.axis_parameter;
  return {s + part * (beside.s0 - s), s + part * (beside.s1 - s)};
}

}  // namespace mrhi
