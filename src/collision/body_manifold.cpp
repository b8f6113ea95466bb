#include "body_manifold.h"

#include <stdexcept>

#include "pair_manifolds.h"

namespace mrhi {
namespace {

double length(const Capsule& core) {
  return (core.end - core.start).norm();
}

/// Each kind of pair is computed one way round: the longer of two cores, the round one of two prisms, and a
/// mesh come first. Computed the other way round a manifold's normal turns; its points, midway between the
/// surfaces, and their depths are the same.
bool comes_first(const ManifoldShape& a, const ManifoldShape& b) {
  if (a.core && b.core) return length(*a.core) >= length(*b.core);
  if (a.core || b.core) return a.core.has_value();
  if (a.prism && b.prism) return a.prism->round || !b.prism->round;
  return a.mesh != nullptr || b.mesh == nullptr;
}

}  // namespace

ManifoldShape::ManifoldShape(const Shape& placed, const MeshCollider* collider)
    : shape(placed),
      mesh(collider),
      core(std::visit([](const auto& asked) { return asked.core(); }, placed)),
      prism(std::visit([](const auto& asked) { return asked.prism(); }, placed)),
      bounding_radius(mrhi::bounding_radius(placed)) {
  if (std::holds_alternative<Mesh>(placed) && collider == nullptr) {
    throw std::invalid_argument("a mesh needs its MeshCollider to be a ManifoldShape");
  }
}

Manifold body_manifold(const ManifoldShape& a, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin, double least_breadth) {
  const double reach = a.bounding_radius + b.bounding_radius + margin;
  if ((pose_a.position - pose_b.position).squaredNorm() > reach * reach) return {};
  if (!comes_first(a, b)) {
    Manifold manifold = body_manifold(b, pose_b, a, pose_a, margin, least_breadth);
    manifold.normal = -manifold.normal;
    for (Vector3& normal : manifold.other_normals) normal = -normal;
    return manifold;
  }
  if (a.core) return core_manifold(*a.core, pose_a, b, pose_b, margin);
  if (a.prism && b.prism) return prism_manifold(a, pose_a, b, pose_b, margin, least_breadth);
  return mesh_manifold(a, pose_a, b, pose_b, margin);
}

}  // namespace mrhi
