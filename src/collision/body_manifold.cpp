#include "body_manifold.h"

#include <stdexcept>

#include "pair_manifolds.h"

namespace mrhi {
namespace {

/// Each kind of pair is computed one way round; `turned` is the other.
Manifold turned(Manifold manifold) {
  manifold.normal = -manifold.normal;
  return manifold;
}

double length(const Capsule& core) {
  return (core.end - core.start).norm();
}

/// Of what has a form of its own; everything else goes by its corners and edges.
struct Pair {
  const ManifoldShape& a;
  const Pose& pose_a;
  const ManifoldShape& b;
  const Pose& pose_b;
  double margin;

  Manifold operator()(const Box& box_a, const Box& box_b) const {
    return box_box({box_a, pose_a}, {box_b, pose_b}, margin);
  }
  Manifold operator()(const Cylinder& cylinder, const Box& box) const {
    return cylinder_box({cylinder, pose_a}, {box, pose_b}, margin);
  }
  Manifold operator()(const Cylinder& of_a, const Cylinder& of_b) const {
    return cylinder_cylinder({of_a, pose_a}, {of_b, pose_b}, margin);
  }
  Manifold operator()(const Box& box, const Cylinder& cylinder) const {
    return turned(cylinder_box({cylinder, pose_b}, {box, pose_a}, margin));
  }
  template <typename First>
  Manifold operator()(const First&, const Mesh&) const {
    return turned(mesh_manifold(b, pose_b, a, pose_a, margin));
  }
  Manifold operator()(const Mesh&, const Mesh&) const { return mesh_manifold(a, pose_a, b, pose_b, margin); }
  template <typename First, typename Second>
  Manifold operator()(const First&, const Second&) const {
    return mesh_manifold(a, pose_a, b, pose_b, margin);
  }
};

}  // namespace

ManifoldShape::ManifoldShape(const Shape& placed, const MeshCollider* collider)
    : shape(placed),
      mesh(collider),
      core(std::visit([](const auto& asked) { return asked.core(); }, placed)),
      bounding_radius(mrhi::bounding_radius(placed)) {
  if (std::holds_alternative<Mesh>(placed) && collider == nullptr) {
    throw std::invalid_argument("a mesh needs its MeshCollider to be a ManifoldShape");
  }
}

Manifold body_manifold(const ManifoldShape& a, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin) {
  const double reach = a.bounding_radius + b.bounding_radius + margin;
  if ((pose_a.position - pose_b.position).squaredNorm() > reach * reach) return {};
  const bool a_lies_on_b = a.core && !(b.core && length(*a.core) > length(*b.core));
  if (a_lies_on_b) return core_manifold(*a.core, pose_a, b, pose_b, margin);
  if (b.core) return turned(core_manifold(*b.core, pose_b, a, pose_a, margin));
  return std::visit(Pair{a, pose_a, b, pose_b, margin}, a.shape, b.shape);
}

}  // namespace mrhi
