#include "flat_part.h"
#include "prism.h"

namespace mrhi {
namespace {

/// The axis of a capsule and what it is seen from a cylinder's own axis, z. With rho(s) the distance from z
/// and R the radius, d^2 = max(0, rho - R)^2 + excess(z)^2.
struct AxisByCylinder {
  const Segment& axis;
  const Cylinder& cylinder;
  Eigen::Vector2d start = axis.start.head<2>(), along = axis.along.head<2>();
  double along_squared = along.squaredNorm();

  double beyond_cap(double s) const {
    return excess(axis.start.z() + s * axis.along.z(), cylinder.half_length);
  }
  /// Half the derivative of the squared distance from the cylinder by s, and the derivative of that.
  ///     rho' = place.along / rho,   rho rho'' = along^2 - rho'^2   (along seen along z)
  ///     d d' = (rho - R) rho' + z' excess(z)
  ///     its derivative = z'^2 + rho'^2 + (rho - R) rho'' = z'^2 + along^2 - (R / rho) (along^2 - rho'^2)
  /// The last is that beyond the rim, where both parts are at work. It is never negative, as R < rho there.
  double slope(double s, double* change = nullptr) const {
    const Eigen::Vector2d place = start + s * along;
    const double from_axis = place.norm(), run = place.dot(along);
    const double beyond_side = std::max(0.0, excess(from_axis, cylinder.radius));
    double sum = axis.along.z() * beyond_cap(s);
    if (beyond_side > 0.0) sum += beyond_side * run / from_axis;
    if (change != nullptr && beyond_side > 0.0) {
      const double turn = run / from_axis;
      *change = axis.along.z() * axis.along.z() + along_squared -
                cylinder.radius / from_axis * (along_squared - turn * turn);
    }
    return sum;
  }
};

/// Beyond the rim: a quartic, by Newton's method held in its bracket. d d' = 0 has the square root rho in it:
/// squared away it is of fourth degree, whose closed roots cancel badly. Newton's step is taken while it
/// stays in lo..hi, else the bracket is halved; it ends where s does not move by 1e-16.
double nearest_to_rim(const AxisByCylinder& seen, double lo, double hi) {
  double s = 0.5 * (lo + hi);
  for (int i = 0; i < 100 && hi - lo > 1e-16; ++i) {
    double change = 0.0;
    const double slope = seen.slope(s, &change);
    if (slope == 0.0) return s;
    (slope < 0.0 ? lo : hi) = s;
    const double newton = change > 0.0 ? s - slope / change : lo;
    const double next = newton > lo && newton < hi ? newton : 0.5 * (lo + hi);
    if (std::abs(next - s) < 1e-16) return next;
    s = next;
  }
  return s;
}

/// Where the axis crosses the planes of the caps and the side's surface, the slope changes its form. That is
/// at z = +-half_length and at rho = R, whose roots are s = f -+ sqrt((R^2 - m^2) / along^2) about the foot
/// f, where the axis passes z at the distance m.
void add_crossings(const AxisByCylinder& seen, ConvexMinimum& minimum) {
  const auto add = [&](double s) {
    if (minimum.holds(s)) minimum.add(s, seen.slope(s));
  };
  const double rise = seen.axis.along.z();
  if (rise != 0.0) {
    add((-seen.cylinder.half_length - seen.axis.start.z()) / rise);
    add((seen.cylinder.half_length - seen.axis.start.z()) / rise);
  }
  if (seen.along_squared == 0.0) return;
  const double nearest = -seen.start.dot(seen.along) / seen.along_squared;
  const double miss = (seen.start + nearest * seen.along).squaredNorm();
  const double half_chord_squared = seen.cylinder.radius * seen.cylinder.radius - miss;
  if (half_chord_squared <= 0.0) return;
  const double half_chord = std::sqrt(half_chord_squared / seen.along_squared);
  add(nearest - half_chord);
  add(nearest + half_chord);
}

/// Between two crossings the middle tells which surface is nearest:
///     rho <= R:                above a cap or inside; the slope is linear in s
///     z within the caps:       beside the side; rho is least at the foot -start.along / along^2
///     neither:                 beyond a rim
double nearest(const Segment& axis, const Cylinder& cylinder) {
  const AxisByCylinder seen{axis, cylinder};
  ConvexMinimum minimum(seen.slope(0.0), seen.slope(1.0));
  if (minimum.done()) return minimum.linear();
  add_crossings(seen, minimum);
  if (minimum.has_zero()) return minimum.linear();
  const double middle = 0.5 * (minimum.lo() + minimum.hi());
  if ((seen.start + middle * seen.along).norm() <= cylinder.radius) return minimum.linear();
  if (seen.beyond_cap(middle) != 0.0) return nearest_to_rim(seen, minimum.lo(), minimum.hi());
  return std::max(minimum.lo(), std::min(-seen.start.dot(seen.along) / seen.along_squared, minimum.hi()));
}

/// The nearest point of the solid. Nearest on a round side is straight towards z; both parts may be held one
/// after the other, as the side's and the caps' directions are across each other.
Vector3 clamp(const Vector3& place, const Cylinder& cylinder) {
  Vector3 point = place;
  const double from_axis = point.head<2>().norm();
  if (from_axis > cylinder.radius) point.head<2>() *= cylinder.radius / from_axis;
  point.z() = std::max(-cylinder.half_length, std::min(point.z(), cylinder.half_length));
  return point;
}

/// As a box is left by a face: z up or down, the deeper end out last.
ClosestFeatures leave_by_cap(const Segment& axis, const Cylinder& cylinder) {
  const double middle = axis.middle().z(), side = middle < 0.0 ? -1.0 : 1.0;
  double s = side * axis.along.z() > 0.0 ? 0.0 : 1.0;
  if (axis.along.z() == 0.0) {
    Interval over;
    over.clip_to_disc(axis, cylinder.radius);
    s = over.middle();
  }
  Vector3 point = axis.at(s);
  point.z() = side * cylinder.half_length;
  const double reach = 0.5 * std::abs(axis.along.z());
  return {std::abs(middle) - reach - cylinder.half_length, side * Vector3::UnitZ(), point, s};
}

/// Seen along z: a segment in a disc. It leaves along the direction from z to its nearest place, at rho: by
/// R - rho, as all of the segment is beyond the line across that direction (a segment is convex). One that
/// passes z itself leaves across its own direction, and one along z to x: any would do, so always the same.
ClosestFeatures leave_by_side(const Segment& axis, const Cylinder& cylinder) {
  const Eigen::Vector2d start = axis.start.head<2>(), along = axis.along.head<2>();
  const double along_squared = along.squaredNorm();
  double s;
  if (along_squared > 0.0) {
    s = std::max(0.0, std::min(-start.dot(along) / along_squared, 1.0));
  } else {
    Interval beside;
    beside.clip_to_slab(axis.start.z(), axis.along.z(), cylinder.half_length);
    s = beside.middle();
  }
  const Eigen::Vector2d place = start + s * along;
  const double from_axis = place.norm();
  Vector3 normal = Vector3::UnitX();
  if (from_axis > kOnSurface) {
    normal << place / from_axis, 0.0;
  } else if (along_squared > 0.0) {
    normal << Eigen::Vector2d(-along.y(), along.x()).normalized(), 0.0;
  }
  Vector3 point = cylinder.radius * normal;
  point.z() = std::max(-cylinder.half_length, std::min(axis.at(s).z(), cylinder.half_length));
  return {from_axis - cylinder.radius, normal, point, s};
}

/// Across the segment, which is a point then. The directions n with n.along = 0 are a circle, and
/// s(n) = n.middle - h(n) on it is searched for the greatest: no closed form, as h has a root in it. The
/// point is where the solid is farthest along n, and s the segment's foot from there.
ClosestFeatures leave_by_rim(const Segment& axis, const Cylinder& cylinder) {
  const Prism place({Vector3::Zero(), false}, {axis.middle(), Quaternion::Identity()});
  const Prism solid(*cylinder.prism(), {Vector3::Zero(), Quaternion::Identity()});
  ConvexAxis search(place, solid);
  search.try_around(axis.along.normalized());
  const Vector3 point = solid.farthest(search.normal());
  return {search.separation(), search.normal(), point, foot(axis.start, axis.along, point)};
}

/// The shortest translation that takes a segment, which overlaps the cylinder, out of it: distance <= 0. The
/// cylinder swept along the segment is convex; the segment leaves by the nearest piece of its surface: a cap,
/// the side at an end of the segment, or what a rim or a line of the side sweeps. The nearest point of a
/// convex solid's surface, seen from inside, is never on an edge that bulges: so that of the sweep's surface
/// only what has an area counts. The cap comes first, then the side, then what is better than both by more
/// than rounding.
ClosestFeatures leave(const Segment& axis, const Cylinder& cylinder) {
  ClosestFeatures best = leave_by_cap(axis, cylinder);
  const auto take = [&](const ClosestFeatures& exit, double better) {
    if (exit.distance > best.distance + better) best = exit;
  };
  take(leave_by_side(axis, cylinder), 0.0);
  const bool slanted = axis.along.z() != 0.0 && axis.along.head<2>().norm() > 0.0;
  if (slanted) take(leave_by_rim(axis, cylinder), 1e-15);
  return best;
}

}  // namespace

ClosestFeatures Cylinder::closest(const Capsule& capsule, double) const {
  const Segment axis(capsule);
  const double s = nearest(axis, *this);
  const Vector3 axis_point = axis.at(s);
  const Vector3 point = clamp(axis_point, *this);
  const Vector3 gap = axis_point - point;
  const double distance = gap.norm();
  if (distance > kOnSurface) return {distance - capsule.radius, gap / distance, point, s};
  ClosestFeatures features = leave(axis, *this);
  features.distance -= capsule.radius;
  return features;
}

/// The normal tells the feature: a cap along z, the side across z, the rim between.
AxisSpan Cylinder::span(const Capsule& capsule, const ClosestFeatures& features) const {
  const Segment axis(capsule);
  if (axis.along.isZero(0.0)) return at_point(features);
  if (features.normal.head<2>().norm() <= kSameNormal) {
    Interval stretch;
    stretch.clip_to_disc(axis, radius);
    return over(stretch, features);
  }
  if (std::abs(features.normal.z()) > kSameNormal) return at_edge(features);
  return beside_round_side(axis, features, half_length);
}

std::optional<Capsule> Cylinder::core() const {
  return std::nullopt;
}

double Cylinder::bounding_radius() const {
  return std::hypot(radius, half_length);
}

Vector3 Cylinder::farthest(const Vector3& n) const {
  const double level = n.head<2>().norm(), scale = level > 0.0 ? radius / level : 0.0;
  return {scale * n.x(), scale * n.y(), n.z() < 0.0 ? -half_length : half_length};
}

std::optional<double> Cylinder::exit_distance(const Vector3& point, const Vector3& direction) const {
  Chord chord;
  chord.clip_to_slab(point.z(), direction.z(), half_length);
  chord.clip_to_ball(Eigen::Vector2d(point.head<2>()), Eigen::Vector2d(direction.head<2>()), radius);
  return chord.out();
}

///     V = 2 pi r^2 h,   x^2: V r^2 / 4,   z^2: V h^2 / 3   (h the half length)
SolidMoments Cylinder::moments() const {
  constexpr double kPi = 3.141592653589793;
  const double square = radius * radius;
  const double volume = 2.0 * kPi * square * half_length;
  const Vector3 second(0.25 * square, 0.25 * square, half_length * half_length / 3.0);
  return {volume, Vector3::Zero(), (volume * second).asDiagonal()};
}

}  // namespace mrhi
