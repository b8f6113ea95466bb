#include "cylinder_penetration.h"

namespace mrhi {
namespace {

using Vector2 = Eigen::Vector2d;

// The cylinder swept along the segment is convex; the segment leaves by the nearest piece of its surface.
// These are flat (a cap), the cylinder's side at an end of the segment, and what a rim or a line of the side
// sweeps.

ClosestFeatures leave_by_cap(const Segment& axis, const Cylinder& cylinder) {
  const double middle = axis.middle().z(), side = middle < 0.0 ? -1.0 : 1.0;
  double s = side * axis.along.z() > 0.0 ? 0.0 : 1.0;
  if (axis.along.z() == 0.0) {
    Stretch over;
    over.clip_to_disc(axis, cylinder.radius);
    s = over.middle();
  }
  Vector3 point = axis.at(s);
  point.z() = side * cylinder.half_length;
  const double reach = 0.5 * std::abs(axis.along.z());
  return {std::abs(middle) - reach - cylinder.half_length, side * Vector3::UnitZ(), point, s};
}

/// Seen along z: a segment in a disc.
ClosestFeatures leave_by_side(const Segment& axis, const Cylinder& cylinder) {
  const Vector2 start = axis.start.head<2>(), along = axis.along.head<2>();
  const double along_squared = along.squaredNorm();
  double s;
  if (along_squared > 0.0) {
    s = std::max(0.0, std::min(-start.dot(along) / along_squared, 1.0));
  } else {
    Stretch beside;
    beside.clip_to_slab(axis.start.z(), axis.along.z(), cylinder.half_length);
    s = beside.middle();
  }
  const Vector2 place = start + s * along;
  const double from_axis = place.norm();
  Vector3 normal = Vector3::UnitX();
  if (from_axis > kOnSurface) {
    normal << place / from_axis, 0.0;
  } else if (along_squared > 0.0) {
    normal << Vector2(-along.y(), along.x()).normalized(), 0.0;
  }
  Vector3 point = cylinder.radius * normal;
  point.z() = std::max(-cylinder.half_length, std::min(axis.at(s).z(), cylinder.half_length));
  return {from_axis - cylinder.radius, normal, point, s};
}

/// Seen along the segment, which is a point then: the rim is an ellipse.
std::optional<ClosestFeatures> leave_by_rim(const Segment& axis, const Cylinder& cylinder) {
  const double length = axis.along.norm(), level = axis.along.head<2>().norm();
  const double cosine = level / length, sine = axis.along.z() / length;
  const Vector2 ahead = axis.along.head<2>() / level;
  Vector3 across(-ahead.y(), ahead.x(), 0.0);
  Vector3 up(-sine * ahead.x(), -sine * ahead.y(), cosine);
  const Vector3 middle = axis.middle();
  if (across.dot(middle) < 0.0) across = -across;
  if (up.dot(middle) < 0.0) up = -up;
  const Vector2 place(across.dot(middle), up.dot(middle) - cylinder.half_length * cosine);

  const double a = cylinder.radius, b = std::max(cylinder.radius * std::abs(sine), kParallel);
  const std::optional<Vector2> on_rim = nearest_on_ellipse(a, b, place);
  if (!on_rim) return std::nullopt;
  const Vector2& nearest = *on_rim;
  const Vector2 outward = Vector2(nearest.x() / a, nearest.y() / b * (a / b)).normalized();
  const Vector3 normal = outward.x() * across + outward.y() * up;
  const double separation = outward.dot(place - nearest);
  Vector3 point;
  point << cylinder.radius * normal.head<2>().normalized(), normal.z() < 0.0 ? -1.0 : 1.0;
  point.z() *= cylinder.half_length;
  const double s = (point - axis.start).dot(axis.along) / (length * length);
  return ClosestFeatures{separation, normal, point, std::max(0.0, std::min(s, 1.0))};
}

}  // namespace

ClosestFeatures leave_cylinder(const Segment& axis, const Cylinder& cylinder) {
  ClosestFeatures best = leave_by_cap(axis, cylinder);
  const ClosestFeatures side = leave_by_side(axis, cylinder);
  if (side.distance > best.distance) best = side;
  const bool slanted = axis.along.z() != 0.0 && axis.along.head<2>().norm() > 0.0;
  if (slanted) {
    const std::optional<ClosestFeatures> rim = leave_by_rim(axis, cylinder);
    if (rim && rim->distance > best.distance + 1e-15) best = *rim;
  }
  return best;
}

// The place is (x a^2 / (t + a^2), y b^2 / (t + b^2)) for a root t of a convex function (Eberly, Distance
// from a Point to an Ellipse), here in units of b^2. Newton's method from the side of the pole at -1 cannot
// overshoot it.
std::optional<Eigen::Vector2d> nearest_on_ellipse(double a, double b, const Eigen::Vector2d& place) {
  const double ratio = (a / b) * (a / b), u = place.x() / a, v = place.y() / b;
  if (v == 0.0) {
    if (u * ratio >= ratio - 1.0) return std::nullopt;
    const double x = u * ratio / (ratio - 1.0);
    return Vector2(a * x, b * std::sqrt(1.0 - x * x));
  }
  double t = v > 0.0 ? std::max(v - 1.0, ratio * (u - 1.0)) : v - 1.0;
  for (int i = 0; i < 200; ++i) {
    if (t <= -ratio) return std::nullopt;
    const double p = ratio * u / (t + ratio), q = v / (t + 1.0);
    const double value = p * p + q * q - 1.0, descent = p * p / (t + ratio) + q * q / (t + 1.0);
    if (value <= 0.0) break;
    if (v * descent <= 0.0) return std::nullopt;
    const double next = t + 0.5 * value / descent;
    if (next == t) break;
    t = next;
  }
  return Vector2(a * ratio * u / (t + ratio), b * v / (t + 1.0));
}

}  // namespace mrhi
