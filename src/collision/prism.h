#pragma once

#include <array>
#include <cmath>

#include "mr_hand_interaction/scene/shape.h"
#include "segment.h"

namespace mrhi {

/// A prism placed in world, by its support function `reach` h(n), the extent from the centre along a unit n,
/// and its support point `farthest`, relative to the centre. Symmetric about its centre.
struct Prism {
  Prism(const PrismForm& form, const Pose& pose)
      : centre(pose.position),
        axes(pose.orientation.toRotationMatrix()),
        half(form.half),
        round(form.round) {}

  /// Axes from here to 2 have flat faces at their ends and straight lines along them: of a disc only z.
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
  /// it is the corner on the positive sides, or the cap's middle.
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

/// The direction, out of b towards a, along which two prisms are farthest apart or overlap least: the
/// greatest s(n) = n.(centre a - centre b) - reach a(n) - reach b(n). Every direction tried bounds it from
/// below, so that a translation by -s always separates; it is exact if the best direction was tried. Prisms
/// are symmetric about their centres: n and -n are one try.
///
/// The separating axis (Gottschalk, Lin & Manocha 1996; Ericson, Real-Time Collision Detection, 5.2.1): a and
/// b overlap if and only if the origin is in their Minkowski difference a - b, and n.x <= h(n) bounds a
/// convex set by its support function h. The greatest s is the origin's signed distance from a - b: the gap,
/// or less the depth of the least translation.
class ConvexAxis {
 public:
  ConvexAxis(const Prism& a, const Prism& b) : a_(a), b_(b), offset_(a.centre - b.centre) {}

  double separation() const { return separation_; }
  const Vector3& normal() const { return normal_; }
  /// The greatest separation along the flats' normals that are at least 60 degrees off the best of them: less
  /// than 0 where the shapes overlap in all directions across it. Call after try_flats.
  double separation_across() const {
    double across = -1e300;
    for (int i = 0; i < flats_; ++i) {
      const Flat& flat = flat_[i];
      if (std::abs(flat.normal.dot(normal_)) < 0.5) across = std::max(across, flat.separation);
    }
    return across;
  }
  const Vector3& offset() const { return offset_; }

  /// The normals of flat faces of both. In the frame of the one whose face it is n is a unit axis: its own
  /// reach is half[i], and the other sees row or column i of turn = A^T B. |n.offset| stands for the better
  /// of n and -n; the sign is settled once for the winner.
  void try_flats() {
    const Matrix3 turn = a_.axes.transpose() * b_.axes;
    const Vector3 in_a = a_.axes.transpose() * offset_, in_b = b_.axes.transpose() * offset_;
    flats_ = 0;
    for (int i = a_.first_flat(); i < 3; ++i)
      take_flat(std::abs(in_a[i]) - a_.half[i] - b_.reach_along(turn.row(i)), a_.axes.col(i));
    for (int i = b_.first_flat(); i < 3; ++i)
      take_flat(std::abs(in_b[i]) - b_.half[i] - a_.reach_along(turn.col(i)), b_.axes.col(i));
    if (normal_.dot(offset_) < 0.0) normal_ = -normal_;
  }
  /// Any length; zero is no direction. The sign with n.offset >= 0 is the better one: both reaches are even
  /// in n. The cross product of parallel edges has no direction; there the flats, or another edge, have the
  /// answer.
  void try_direction(Vector3 n) {
    const double length = n.norm();
    if (length < kParallel) return;
    n *= (n.dot(offset_) < 0.0 ? -1.0 : 1.0) / length;
    take(at(n), n);
  }

  /// Tries the local maxima among the directions across a unit axis: an edge or a side there, a rim on the
  /// other shape. Seen along the axis the shapes are convex figures; the slope of s falls wherever it jumps.
  /// On the half circle n(phi) from -90 to 90 degrees about the offset; on the other half n.offset < 0. With
  /// the farthest points fixed (a support function's derivative is its farthest point) ds/dphi = n'.apart,
  /// and
  ///     d2s/dphi2 = -s - n'.(bend a + bend b) n' <= -s :
  /// where s > 0 it is concave and has a single top; overlapping it may have several, of which one is found
  /// between two of the 12 rays. Jumps of the farthest point from corner to corner only make the slope fall,
  /// as h is convex.
  void try_around(const Vector3& axis) {
    Vector3 ahead = offset_ - axis.dot(offset_) * axis;
    ahead = ahead.norm() > kParallel ? Vector3(ahead.normalized()) : any_normal(axis);
    Ray from = ray(-axis.cross(ahead), ahead);
    for (int i = 0; i < kSteps; ++i) {
      const Ray to = turned(from, kCosine, kSine);
      if (from.slope > 0.0 && to.slope <= 0.0 && bound(from, to, kStep) > separation_) refine(from, to);
      from = to;
    }
  }

  /// Newton's ascent over all directions, for rim on rim: there s is smooth. s on the sphere has the gradient
  /// g = apart - (n.apart) n and the Hessian -(s 1 + bend a + bend b) across n. It may have several tops: the
  /// caller brings the starts. A step that does not rise is halved, and n ends on the best that was seen.
  void climb(Vector3 n) {
    if (n.norm() < kParallel) return;
    n.normalize();
    for (int i = 0; i < 20; ++i) {
      const Vector3 gradient = across(n);
      if (gradient.norm() < 1e-15) break;
      Vector3 step = ascent(n, gradient);
      if (step.norm() > kMaxStep) step *= kMaxStep / step.norm();
      const double before = at(n);
      Vector3 next = (n + step).normalized();
      for (int halvings = 0; halvings < 8 && at(next) <= before; ++halvings) {
        step *= 0.5;
        next = (n + step).normalized();
      }
      if (at(next) <= before) break;
      const bool arrived = (next - n).squaredNorm() < 1e-24;
      n = next;
      if (arrived) break;
    }
    try_direction(n);
  }

 private:
  static constexpr double kMinImprovement =
      1e-10;                               // later tries must beat earlier ones by this: faces come first [m]
  static constexpr double kMaxStep = 0.3;  // [rad]
  static constexpr int kSteps = 12;
  static constexpr double kStep = 0.2617993877991494;  // pi / kSteps
  static constexpr double kCosine = 0.9659258262890683, kSine = 0.25881904510252074;

  /// A direction n on a circle, where it turns to (n'), s and ds/dangle.
  struct Ray {
    Vector3 n, turn;
    double value, slope;
  };

  void take_flat(double separation, const Vector3& n) {
    flat_[flats_++] = {n, separation};
    take(separation, n);
  }
  void take(double separation, const Vector3& n) {
    if (separation > separation_ + kMinImprovement) separation_ = separation, normal_ = n;
  }
  double at(const Vector3& n) const { return n.dot(offset_) - a_.reach(n) - b_.reach(n); }
  /// From b's farthest point to a's.
  Vector3 between(const Vector3& n) const { return offset_ - a_.farthest(n) - b_.farthest(n); }
  Vector3 across(const Vector3& n) const {
    const Vector3 apart = between(n);
    return apart - n.dot(apart) * n;
  }
  Ray ray(const Vector3& n, const Vector3& turn) const {
    const Vector3 apart = between(n);
    return {n, turn, n.dot(apart), turn.dot(apart)};
  }
  Ray turned(const Ray& from, double cosine, double sine) const {
    return ray(cosine * from.n + sine * from.turn, cosine * from.turn - sine * from.n);
  }

  /// Not much less than the greatest s between two rays: where their tangents meet. Lines from both ends as
  /// far as they go, and 0.5 |s| angle^2 for what s may curve upwards where it is negative (s'' <= -s, with s
  /// at the first ray for that in between).
  static double bound(const Ray& from, const Ray& to, double angle) {
    const double falls = from.slope - to.slope;
    const double meet = falls > 0.0 ? (to.value - from.value - to.slope * angle) / falls : 0.0;
    const double curved = 0.5 * std::abs(from.value) * angle * angle;
    return from.value + from.slope * std::max(0.0, std::min(meet, angle)) + curved;
  }

  /// Newton's method on ds/dphi in the bracket lo..hi, halved where Newton leaves it: at a jump of the slope
  /// it never settles, and halving finds the corner. Ends early once the bracket cannot beat what is known.
  void refine(const Ray& from, const Ray& to) {
    double lo = 0.0, hi = kStep;
    double angle = kStep * from.slope / (from.slope - to.slope);
    Ray low = from, high = to, now = from;
    for (int i = 0; i < 60; ++i) {
      now = turned(from, std::cos(angle), std::sin(angle));
      (now.slope > 0.0 ? low : high) = now;
      (now.slope > 0.0 ? lo : hi) = angle;
      if (bound(low, high, hi - lo) < separation_ + kMinImprovement) return;
      const double curvature = now.value + now.turn.dot((a_.bend(now.n) + b_.bend(now.n)) * now.turn);
      double next = angle + now.slope / curvature;
      if (!(curvature > 0.0 && next > lo && next < hi)) next = 0.5 * (lo + hi);
      if (std::abs(next - angle) < 1e-14) break;
      angle = next;
    }
    try_direction(now.n);
  }

  /// Newton's step, or up the gradient where s is not concave. In the basis u, v across n:
  /// step = (s 1 + bend a + bend b)^-1 gradient, by Cramer's rule; concave if trace and determinant are
  /// positive.
  Vector3 ascent(const Vector3& n, const Vector3& gradient) const {
    const Vector3 u = any_normal(n), v = n.cross(u);
    const Matrix3 curve = at(n) * Matrix3::Identity() + a_.bend(n) + b_.bend(n);
    const double uu = u.dot(curve * u), uv = u.dot(curve * v), vv = v.dot(curve * v);
    const double gu = u.dot(gradient), gv = v.dot(gradient), det = uu * vv - uv * uv;
    if (det > 1e-12 * (uu * uu + vv * vv) && uu + vv > 0.0) {
      return (vv * gu - uv * gv) / det * u + (uu * gv - uv * gu) / det * v;
    }
    return kMaxStep / gradient.norm() * gradient;
  }

  const Prism& a_;
  const Prism& b_;
  Vector3 offset_, normal_ = Vector3::UnitZ();
  double separation_ = -1e300;
  struct Flat {
    Vector3 normal;
    double separation;
  };
  std::array<Flat, 6> flat_;
  int flats_ = 0;
};

}  // namespace mrhi
