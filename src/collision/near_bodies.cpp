#include "near_bodies.h"

#include <limits>

namespace mrhi {

HandExtent::HandExtent(const Hand& hand)
    : min_(Vector3::Constant(std::numeric_limits<double>::max())), max_(-min_) {
  for (const Capsule& capsule : hand.capsules) {
    if (capsule.radius <= 0.0) continue;
    const Vector3 reach = Vector3::Constant(capsule.radius);
    min_ = min_.cwiseMin(capsule.start.cwiseMin(capsule.end) - reach);
    max_ = max_.cwiseMax(capsule.start.cwiseMax(capsule.end) + reach);
  }
}

/// Per axis at most one of min - c and c - max is positive; the length of these three is how far the centre
/// is from the box (Arvo 1990).
bool HandExtent::reaches(const Vector3& centre, double radius) const {
  const Vector3 outside = (min_ - centre).cwiseMax(centre - max_).cwiseMax(0.0);
  return outside.squaredNorm() <= radius * radius;
}

std::vector<int> near_bodies(const Hand& hand, const Scene& scene, const std::vector<BodyState>& bodies,
                             double margin) {
  const HandExtent extent(hand);
  std::vector<int> near;
  for (std::size_t b = 0; b < bodies.size(); ++b) {
    if (extent.reaches(bodies[b].pose.position, scene.bodies[b].bounding_radius + margin))
      near.push_back(static_cast<int>(b));
  }
  return near;
}

}  // namespace mrhi
