#pragma once

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// What a segment rises or runs by less than this counts as nothing: it is parallel, or a point [m].
constexpr double kParallel = 1e-12;
/// An axis nearer to a surface than this lies on it: the direction between the two would be rounding [m].
constexpr double kOnSurface = 1e-11;

/// A capsule's axis start + s * along, s in 0..1, with along's rounding taken off.
struct Segment {
  explicit Segment(const Capsule& capsule) : start(capsule.start), along(capsule.end - capsule.start) {
    for (int i = 0; i < 3; ++i) {
      if (std::abs(along[i]) < kParallel) along[i] = 0.0;
    }
  }
  Vector3 at(double s) const { return start + s * along; }
  Vector3 middle() const { return start + 0.5 * along; }
  Vector3 end() const { return start + along; }

  Vector3 start, along;
};

/// How far x lies beyond -half..half, with its sign; nothing within rounding.
inline double excess(double x, double half) {
  const double beyond = x - std::max(-half, std::min(x, half));
  return std::abs(beyond) < 1e-15 ? 0.0 : beyond;
}

/// A part of a segment.
struct Stretch {
  double s0 = 0.0, s1 = 1.0;

  double middle() const { return std::max(0.0, std::min(0.5 * (s0 + s1), 1.0)); }
  /// Adds what goes on where this ends.
  void join(const Stretch& next) {
    if (next.s0 > s1 + 1e-9 || next.s1 < s0 - 1e-9) return;
    s0 = std::min(s0, next.s0), s1 = std::max(s1, next.s1);
  }
  /// Keeps what has |x0 + s * dx| <= half.
  void clip_to_slab(double x0, double dx, double half) {
    if (std::abs(x0) <= half && std::abs(x0 + dx) <= half) return;
    clip(-x0, -dx, half), clip(x0, dx, half);
  }
  /// Keeps what is no farther than `radius` from the z axis.
  void clip_to_disc(const Segment& axis, double radius) {
    const Eigen::Vector2d start = axis.start.head<2>(), along = axis.along.head<2>();
    const double along_squared = along.squaredNorm();
    if (along_squared == 0.0) return;
    const double nearest = -start.dot(along) / along_squared;
    const double miss = (start + nearest * along).squaredNorm();
    const double half_chord = std::sqrt(std::max(0.0, radius * radius - miss) / along_squared);
    s0 = std::max(s0, nearest - half_chord);
    s1 = std::min(s1, nearest + half_chord);
  }
  /// Keeps what has x0 + s * dx <= bound.
  void clip(double x0, double dx, double bound) {
    if (dx > 0.0) s1 = std::min(s1, (bound - x0) / dx);
    if (dx < 0.0) s0 = std::max(s0, (bound - x0) / dx);
  }
};

/// Closes in on the minimum of a convex function of s in 0..1 by its slope at chosen places. Where the slope
/// is zero over a stretch, its middle is the minimum.
class ConvexMinimum {
 public:
  ConvexMinimum(double slope_at_0, double slope_at_1) : slope_lo_(slope_at_0), slope_hi_(slope_at_1) {
    if (slope_at_0 == 0.0) zero(0.0);
    if (slope_at_1 == 0.0) zero(1.0);
    if (slope_at_0 > 0.0) hi_ = 0.0;
    if (slope_at_1 < 0.0) lo_ = 1.0;
  }

  /// The minimum is known: an end, or the whole is flat.
  bool done() const { return lo_ >= hi_ || flat_.s0 < flat_.s1; }
  bool holds(double s) const { return s > lo_ && s < hi_; }
  void add(double s, double slope) {
    if (slope < 0.0) lo_ = s, slope_lo_ = slope;
    if (slope > 0.0) hi_ = s, slope_hi_ = slope;
    if (slope == 0.0) zero(s);
  }
  bool has_zero() const { return flat_.s0 <= flat_.s1; }
  double lo() const { return lo_; }
  double hi() const { return hi_; }

  /// The minimum, if the slope is linear between the places given.
  double linear() const {
    if (hi_ <= 0.0) return 0.0;
    if (lo_ >= 1.0) return 1.0;
    if (has_zero()) return flat_.middle();
    return lo_ + (hi_ - lo_) * slope_lo_ / (slope_lo_ - slope_hi_);
  }

 private:
  void zero(double s) { flat_.s0 = std::min(flat_.s0, s), flat_.s1 = std::max(flat_.s1, s); }

  double lo_ = 0.0, hi_ = 1.0, slope_lo_, slope_hi_;
  Stretch flat_{2.0, -1.0};
};

/// A unit vector across v, the same for the same v; v may be zero.
inline Vector3 any_normal(const Vector3& v) {
  int least = 2;
  for (int i = 1; i >= 0; --i) {
    if (std::abs(v[i]) < std::abs(v[least])) least = i;
  }
  const double length_squared = v.squaredNorm();
  if (length_squared == 0.0) return Vector3::UnitZ();
  return (Vector3::Unit(least) - v[least] / length_squared * v).normalized();
}

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
