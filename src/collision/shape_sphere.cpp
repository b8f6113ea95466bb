#include "flat_part.h"

namespace mrhi {

/// The axis is nearest to the centre at its foot s = -start.along / along^2, held in 0..1; the distance is
/// |a(s)| less both radii, along a(s). Through the centre every direction across the axis is as short.
ClosestFeatures capsule_sphere(const Capsule& capsule, const Sphere& sphere) {
  const Segment axis(capsule);
  const double s = foot(axis.start, axis.along, Vector3::Zero());
  const Vector3 axis_point = axis.at(s);
  const double distance = axis_point.norm();
  const Vector3 normal = distance > kOnSurface ? Vector3(axis_point / distance) : any_normal(axis.along);
  return {distance - sphere.radius - capsule.radius, normal, sphere.radius * normal, s};
}

ClosestFeatures Sphere::closest(const Capsule& capsule, double) const {
  return capsule_sphere(capsule, *this);
}

AxisSpan Sphere::span(const Capsule&, const ClosestFeatures& features) const {
  return at_point(features);
}

std::optional<Capsule> Sphere::core() const {
  return Capsule{Vector3::Zero(), Vector3::Zero(), radius};
}

Vector3 Sphere::farthest(const Vector3& n) const {
  return radius * n.normalized();
}

std::optional<double> Sphere::exit_distance(const Vector3& point, const Vector3& direction) const {
  Chord chord;
  chord.clip_to_ball(point, direction, radius);
  return chord.out();
}

///     V = 4/3 pi r^3,   x^2: V r^2 / 5
SolidMoments Sphere::moments() const {
  constexpr double kPi = 3.141592653589793;
  const double volume = 4.0 / 3.0 * kPi * radius * radius * radius;
  return {volume, Vector3::Zero(), 0.2 * volume * radius * radius * Matrix3::Identity()};
}

}  // namespace mrhi
