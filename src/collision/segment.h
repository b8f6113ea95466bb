#pragma once

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Components of a segment below this are set to 0 [m], so that later code can test for exact zeros: some
/// thousand times the rounding of coordinates near 1 m.
constexpr double kParallel = 1e-12;
/// Largest distance of an axis that lies on a surface [m]: of coordinates near 1 m, rounded to some 1e-16 m,
/// a direction at 1e-11 m is still right to 1e-5 rad.
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

/// Signed distance of x beyond -half..half; 0 within rounding. The squared distance from a box
/// is the sum of these squared (Ericson, Real-Time Collision Detection, 5.1.3). The limit is absolute, some
/// ulps of a coordinate of 1 m, and makes the zeros exact that ConvexMinimum counts on: a clamp and a product
/// that meet at a face's plane differ by an ulp.
inline double excess(double x, double half) {
  const double beyond = x - std::max(-half, std::min(x, half));
  return std::abs(beyond) < 1e-15 ? 0.0 : beyond;
}

/// Interval of a segment's parameter.
struct Interval {
  double s0 = 0.0, s1 = 1.0;

  double middle() const { return std::max(0.0, std::min(0.5 * (s0 + s1), 1.0)); }
  /// Clips to |x0 + s * dx| <= half. Returns early if both ends are within, as the quotients could cut an end
  /// off by an ulp.
  void clip_to_slab(double x0, double dx, double half) {
    if (std::abs(x0) <= half && std::abs(x0 + dx) <= half) return;
    if (dx == 0.0 && std::abs(x0) > half + kOnSurface) s0 = 1.0, s1 = 0.0;
    clip(-x0, -dx, half), clip(x0, dx, half);
  }
  /// Clips to within `radius` of the z axis. |x + s d|^2 = r^2, seen along z, has the roots s = f -+
  /// sqrt((r^2 - m^2) / d^2) about the foot f = -x.d / d^2, where the line misses z by m: without the foot,
  /// far starts would cancel. Of a line that misses the disc the foot alone is kept.
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
  /// Clips to x0 + s * dx <= bound.
  void clip(double x0, double dx, double bound) {
    if (dx > 0.0) s1 = std::min(s1, (bound - x0) / dx);
    if (dx < 0.0) s0 = std::max(s0, (bound - x0) / dx);
  }
};

/// Minimises a convex function of s in 0..1 by its slope at chosen points. If the slope is zero over an
/// interval, its centre is the minimum.
///
/// The slope f'(s) of a convex f never falls: it brackets the minimum in lo..hi with f'(lo) < 0 < f'(hi), and
/// where f' is linear between the two its zero is lo + (hi - lo) f'(lo) / (f'(lo) - f'(hi)), without
/// iterations. All points where f' bends have to be added before a call of linear(). A zero counts only if it
/// is exact.
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

  /// The minimum, if the slope is linear between the added points.
  double linear() const {
    if (hi_ <= 0.0) return 0.0;
    if (lo_ >= 1.0) return 1.0;
    if (has_zero()) return flat_.middle();
    return lo_ + (hi_ - lo_) * slope_lo_ / (slope_lo_ - slope_hi_);
  }

 private:
  void zero(double s) { flat_.s0 = std::min(flat_.s0, s), flat_.s1 = std::max(flat_.s1, s); }

  double lo_ = 0.0, hi_ = 1.0, slope_lo_, slope_hi_;
  Interval flat_{2.0, -1.0};
};

/// A unit vector across v, the same for the same v; v may be zero. e - (e.v) v / v^2 of the unit axis e that
/// has the least of v: |e.v| <= |v| / sqrt(3), so that two thirds of e's square are left and nothing cancels.
/// Of components alike the last counts.
inline Vector3 any_normal(const Vector3& v) {
  int smallest = 2;
  for (int i = 1; i >= 0; --i) {
    if (std::abs(v[i]) < std::abs(v[smallest])) smallest = i;
  }
  const double length_squared = v.squaredNorm();
  if (length_squared == 0.0) return Vector3::UnitZ();
  return (Vector3::Unit(smallest) - v[smallest] / length_squared * v).normalized();
}

inline double clamp_unit(double x) {
  return std::max(0.0, std::min(x, 1.0));
}

/// Parameter 0..1 of the point of start + s * along that is nearest to `point`; 0.5 if along is zero.
inline double foot(const Vector3& start, const Vector3& along, const Vector3& point) {
  const double squared = along.squaredNorm();
  return squared == 0.0 ? 0.5 : clamp_unit(along.dot(point - start) / squared);
}

/// Nearest points of a segment and an edge.
struct SegmentPair {
  Interval stretch;  ///< of the segment
  double t;          ///< along the edge, facing the stretch's middle
};

/// Of the segment and the edge from `corner` along `edge`, which has a length (Ericson, Real-Time Collision
/// Detection, 5.1.9). With r = start - corner, d1 and d2 the two directions, the square |r + s d1 - t d2|^2
/// has its least where
///     s a - t b = -c   and   s b - t e = -f,   a = d1.d1, b = d1.d2, c = d1.r, e = d2.d2, f = d2.r,
/// that is at s = (b f - c e) / (a e - b^2). Held in 0..1 one after the other: t facing s, then s facing t.
///
/// The determinant a e - b^2 is |d1 x d2|^2 (Lagrange), but cancels below some 1e-8 rad: so the cross product
/// says what is parallel. Between the two s may come out anywhere, even as no number, which clamp_unit makes
/// 0; the alternating projections then still end at one of many nearest pairs.
inline SegmentPair nearest_points(const Segment& segment, const Vector3& corner, const Vector3& edge) {
  const Vector3 offset = segment.start - corner, &along = segment.along;
  const double a = along.squaredNorm(), e = edge.squaredNorm(), b = along.dot(edge);
  const double c = along.dot(offset), f = edge.dot(offset);
  if (a == 0.0) return {{0.5, 0.5}, clamp_unit(f / e)};
  const bool parallel = along.cross(edge).squaredNorm() <= kParallel * kParallel * e;
  if (parallel) {
    // Facing the edge's ends, at t = 0 and 1: s = (t b - c) / a.
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
