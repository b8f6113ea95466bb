#include "mr_hand_interaction/scene/shape.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

struct BoundingRadius {
  double operator()(const Sphere& sphere) const { return sphere.radius; }
  double operator()(const Box& box) const { return box.half_extents.norm(); }
  double operator()(const Cylinder& cylinder) const {
    return std::hypot(cylinder.radius, cylinder.half_length);
  }
  double operator()(const Mesh& mesh) const {
    double squared = 0.0;
    for (const std::array<int, 3>& triangle : mesh.triangles->triangles) {
      for (const int vertex : triangle) {
        squared = std::max(squared, mesh.triangles->vertices[static_cast<std::size_t>(vertex)].squaredNorm());
      }
    }
    return std::sqrt(squared);
  }
};

}  // namespace

double bounding_radius(const Shape& shape) {
  return std::visit(BoundingRadius{}, shape);
}

}  // namespace mrhi
