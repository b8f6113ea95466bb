#include <algorithm>
#include <cmath>

#include "../scene/solid_mesh.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

std::optional<Capsule> Mesh::core() const {
  return std::nullopt;
}

/// Vertices that no triangle has do not count.
double Mesh::bounding_radius() const {
  double squared = 0.0;
  for (const std::array<int, 3>& triangle : triangles->triangles)
    for (const int v : triangle) squared = std::max(squared, triangles->vertices[v].squaredNorm());
  return std::sqrt(squared);
}

Vector3 Mesh::farthest(const Vector3& n) const {
  const std::vector<Vector3>& corners = triangles->vertices;
  return *std::max_element(corners.begin(), corners.end(),
                           [&](const Vector3& a, const Vector3& b) { return n.dot(a) < n.dot(b); });
}

std::optional<double> Mesh::exit_distance(const Vector3&, const Vector3&) const {
  return std::nullopt;
}

SolidMoments Mesh::moments() const {
  SolidMoments moments = signed_moments(*triangles);
  if (triangles->parts.empty()) return moments;
  const SolidMoments shared = shared_moments(*triangles, moments.volume);
  moments.volume -= shared.volume, moments.first -= shared.first, moments.second -= shared.second;
  return moments;
}

}  // namespace mrhi
