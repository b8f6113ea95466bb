#include "mr_hand_interaction/collision/near_bodies.h"

#include <limits>

namespace mrhi {

std::vector<int> near_bodies(const Hand& hand, const Scene& scene, const std::vector<BodyState>& bodies,
                             double margin) {
  Vector3 min = Vector3::Constant(std::numeric_limits<double>::max()), max = -min;
  for (const Capsule& capsule : hand.capsules) {
    if (capsule.radius <= 0.0) continue;
    const Vector3 reach = Vector3::Constant(capsule.radius + margin);
    min = min.cwiseMin(capsule.start.cwiseMin(capsule.end) - reach);
    max = max.cwiseMax(capsule.start.cwiseMax(capsule.end) + reach);
  }
  std::vector<int> near;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    const Vector3& centre = bodies[b].pose.position;
    const Vector3 outside = (min - centre).cwiseMax(centre - max).cwiseMax(0.0);
    const double radius = scene.bodies[b].bounding_radius;
    if (outside.squaredNorm() <= radius * radius) near.push_back(static_cast<int>(b));
  }
  return near;
}

}  // namespace mrhi
