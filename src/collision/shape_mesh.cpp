#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {
namespace {

template <typename See>
void each_corner(const TriangleMesh& mesh, const See& see) {
  for (const std::array<int, 3>& triangle : mesh.triangles)
    for (const int vertex : triangle) see(mesh.vertices[static_cast<std::size_t>(vertex)]);
}

}  // namespace

std::optional<Capsule> Mesh::core() const {
  return std::nullopt;
}

/// Vertices that no triangle has do not count.
double Mesh::bounding_radius() const {
  double squared = 0.0;
  each_corner(*triangles, [&](const Vector3& corner) { squared = std::max(squared, corner.squaredNorm()); });
  return std::sqrt(squared);
}

Vector3 Mesh::farthest(const Vector3& n) const {
  const std::vector<Vector3>& corners = triangles->vertices;
  return *std::max_element(corners.begin(), corners.end(),
                           [&](const Vector3& a, const Vector3& b) { return n.dot(a) < n.dot(b); });
}

std::optional<double> Mesh::way_out(const Vector3&, const Vector3&) const {
  return std::nullopt;
}

/// By the tetrahedra from the origin to the triangles, with their signs (Tonon 2004).
///
/// Of a tetrahedron with the corners 0, a, b, c:
///     V = a.(b x c) / 6,   integral of x = V (a + b + c) / 4,
///     integral of x x^T = V / 20 (a a^T + b b^T + c c^T + (a + b + c)(a + b + c)^T).
/// V is positive for a triangle that faces away from the origin and negative else, so that what is outside
/// the solid is taken off again: right for a closed mesh alone.
SolidMoments Mesh::moments() const {
  SolidMoments moments;
  for (const std::array<int, 3>& triangle : triangles->triangles) {
    const auto corner = [&](std::size_t i) -> const Vector3& {
      return triangles->vertices[static_cast<std::size_t>(triangle[i])];
    };
    const Vector3 &a = corner(0), &b = corner(1), &c = corner(2);
    const double volume = a.dot(b.cross(c)) / 6.0;
    const Vector3 sum = a + b + c;
    moments.volume += volume;
    moments.first += 0.25 * volume * sum;
    moments.second +=
        0.05 * volume * (a * a.transpose() + b * b.transpose() + c * c.transpose() + sum * sum.transpose());
  }
  return moments;
}

}  // namespace mrhi
