#pragma once

#include "segment.h"

namespace mrhi {

inline double clamp_unit(double x) {
  return std::max(0.0, std::min(x, 1.0));
}

/// Where a segment and an edge are nearest to each other.
struct SegmentPair {
  Stretch stretch;  ///< of the segment
  double t;         ///< along the edge, facing the stretch's middle
};

/// Of the segment and the edge from `corner` along `edge`, which has a length (Ericson, Real-Time Collision
/// Detection, 5.1.9).
inline SegmentPair nearest_stretch(const Segment& segment, const Vector3& corner, const Vector3& edge) {
  const Vector3 offset = segment.start - corner, &along = segment.along;
  const double a = along.squaredNorm(), e = edge.squaredNorm(), b = along.dot(edge);
  const double c = along.dot(offset), f = edge.dot(offset);
  if (a == 0.0) return {{0.5, 0.5}, clamp_unit(f / e)};
  const bool parallel = along.cross(edge).squaredNorm() <= kParallel * kParallel * e;
  if (parallel) {
    const double at_start = -c / a, at_end = (b - c) / a;
    const double s0 = clamp_unit(std::min(at_start, at_end)), s1 = clamp_unit(std::max(at_start, at_end));
    return {{s0, s1}, clamp_unit((0.5 * (s0 + s1) * b + f) / e)};
  }
  double s = clamp_unit((b * f - c * e) / (a * e - b * b));
  const double t = clamp_unit((b * s + f) / e);
  s = clamp_unit((b * t - c) / a);
  return {{s, s}, clamp_unit((b * s + f) / e)};
}

}  // namespace mrhi
