#include "flat_part.h"
#include "segment.h"

namespace mrhi {

/// Two capsules are as far apart as their axes are, less both radii. Where the axes cross, the gap has no
/// direction, and z x along is taken, which is across both; of parallel ones that is zero too, and any normal
/// of z does.
ClosestFeatures Pill::closest(const Capsule& capsule, double) const {
  const Segment axis(capsule);
  const SegmentPair nearest =
      nearest_points(axis, -half_length * Vector3::UnitZ(), 2.0 * half_length * Vector3::UnitZ());
  const double s = nearest.stretch.middle();
  const Vector3 on_axis = (2.0 * nearest.t - 1.0) * half_length * Vector3::UnitZ();
  const Vector3 gap = axis.at(s) - on_axis;
  const double distance = gap.norm();
  Vector3 normal =
      distance > kOnSurface ? Vector3(gap / distance) : Vector3(Vector3::UnitZ().cross(axis.along));
  if (distance <= kOnSurface) {  // the axes cross: across both is the shortest way out
    const double length = normal.norm();
    normal = length > kParallel ? Vector3(normal / length) : any_normal(Vector3::UnitZ());
  }
  return {distance - radius - capsule.radius, normal, on_axis + radius * normal, s};
}

AxisSpan Pill::span(const Capsule& capsule, const ClosestFeatures& features) const {
  const Segment axis(capsule);
  const bool at_end = std::abs(features.normal.z()) > kSameNormal;
  if (at_end || axis.along.isZero(0.0)) return at_point(features);
  return beside_round_side(axis, features, half_length);
}

std::optional<Capsule> Pill::core() const {
  return Capsule{-half_length * Vector3::UnitZ(), half_length * Vector3::UnitZ(), radius};
}

/// A ball's moved by an end: h(n) = r |n| + half_length |n_z|.
Vector3 Pill::farthest(const Vector3& n) const {
  return radius * n.normalized() + (n.z() < 0.0 ? -half_length : half_length) * Vector3::UnitZ();
}

/// The last of its parts that the line leaves. The whole is convex, so that the line is in it without a
/// break, and leaves it where it leaves the last of the three.
std::optional<double> Pill::exit_distance(const Vector3& point, const Vector3& direction) const {
  std::optional<double> last;
  const auto add = [&](const Chord& chord) {
    if (chord.out() && (!last || *chord.out() > *last)) last = chord.out();
  };
  Chord side;
  side.clip_to_slab(point.z(), direction.z(), half_length);
  side.clip_to_ball(Eigen::Vector2d(point.head<2>()), Eigen::Vector2d(direction.head<2>()), radius);
  add(side);
  for (const double end : {-half_length, half_length}) {
    Chord ball;
    ball.clip_to_ball(Vector3(point - end * Vector3::UnitZ()), direction, radius);
    add(ball);
  }
  return last;
}

/// A ball has 1/5 V r^2 about its middle. Of a half ball the middle of mass is 3/8 r beyond the end at h, so
/// that its part of z^2 is V/2 (h^2 + 2 h 3/8 r + r^2 / 5); of both V (h^2 + 3/4 h r + r^2 / 5).
SolidMoments Pill::moments() const {
  constexpr double kPi = 3.141592653589793;
  const double square = radius * radius;
  const double side = 2.0 * kPi * square * half_length, ends = 4.0 / 3.0 * kPi * square * radius;
  const double across = 0.25 * side * square + 0.2 * ends * square;
  const double along = side * half_length * half_length / 3.0 +
                       ends * (half_length * half_length + 0.75 * half_length * radius + 0.2 * square);
  return {side + ends, Vector3::Zero(), Vector3(across, across, along).asDiagonal()};
}

}  // namespace mrhi
