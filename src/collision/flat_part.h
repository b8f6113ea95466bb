#pragma once

#include "closest_features.h"
#include "segment.h"

namespace mrhi {

/// Normals that differ by less than this are the same [rad].
constexpr double kSameNormal = 1e-6;

inline AxisSpan at_point(const ClosestFeatures& features) {
  return {features.axis_parameter, features.axis_parameter};
}
inline AxisSpan at_edge(const ClosestFeatures& features) {
  return {features.axis_parameter, features.axis_parameter, true};
}
/// Part of the axis over the piece of surface whose normal the features have. It always has the point of the
/// features: rounding, or a normal that is only nearly the piece's, must not put the deepest point outside.
inline AxisSpan over(const Stretch& stretch, const ClosestFeatures& features) {
  return {std::min(std::max(stretch.s0, 0.0), features.axis_parameter),
          std::max(std::min(stretch.s1, 1.0), features.axis_parameter)};
}

/// Beside the round side of a shape that is straight along z, from -half to half: the line of touch shrinks
/// to a point while the capsule turns across the side. |(z x n).a| / |a| = sin psi tells by which angle the
/// axis a is turned across the side with the normal n. The span is (1 - sin psi / 0.1) of what stands beside
/// the side, about s: continuous in psi, where a switch from two points to one would throw what friction has
/// stored from one to the other.
inline AxisSpan beside_round_side(const Segment& axis, const ClosestFeatures& features, double half) {
  constexpr double kCrosses = 0.1;  // touches at a point [rad]
  Stretch stretch;
  stretch.clip_to_slab(axis.start.z(), axis.along.z(), half);
  const AxisSpan beside = over(stretch, features);
  const double across = std::abs(Vector3::UnitZ().cross(features.normal).dot(axis.along));
  const double part = std::max(0.0, 1.0 - across / (kCrosses * axis.along.norm()));
  const double s = features.axis_parameter;
  return {s + part * (beside.s0 - s), s + part * (beside.s1 - s)};
}

}  // namespace mrhi
