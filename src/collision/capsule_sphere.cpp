#include "mr_hand_interaction/collision/closest_features.h"
#include "segment.h"

namespace mrhi {

ClosestFeatures capsule_sphere(const Capsule& capsule, const Sphere& sphere) {
  const Segment axis(capsule);
  const double length_squared = axis.along.squaredNorm();
  const double s =
      length_squared > 0.0 ? std::max(0.0, std::min(-axis.start.dot(axis.along) / length_squared, 1.0)) : 0.5;
  const Vector3 axis_point = axis.at(s);
  const double distance = axis_point.norm();
  const Vector3 normal = distance > kOnSurface ? Vector3(axis_point / distance) : any_normal(axis.along);
  return {distance - sphere.radius - capsule.radius, normal, sphere.radius * normal, s};
}

}  // namespace mrhi
