#include "mr_hand_interaction/collision/body_manifold.h"

#include <stdexcept>

#include "box_box.h"
#include "box_face.h"
#include "cylinder_manifold.h"
#include "mesh_manifold.h"
#include "sphere_manifold.h"

namespace mrhi {
namespace {

/// Each kind of pair is computed one way round; `turned` is the other.
Manifold turned(Manifold manifold) {
  manifold.normal = -manifold.normal;
  return manifold;
}

struct Pair {
  const ManifoldShape& a;
  const Pose& pose_a;
  const ManifoldShape& b;
  const Pose& pose_b;
  double margin;

  template <typename Other>
  Manifold operator()(const Sphere& sphere, const Other&) const {
    return sphere_manifold(sphere, pose_a.position, b, pose_b, margin);
  }
  Manifold operator()(const Box& box_a, const Box& box_b) const {
    return box_box({box_a, pose_a}, {box_b, pose_b}, margin);
  }
  Manifold operator()(const Cylinder& cylinder, const Box& box) const {
    return cylinder_box({cylinder, pose_a}, {box, pose_b}, margin);
  }
  Manifold operator()(const Cylinder& of_a, const Cylinder& of_b) const {
    return cylinder_cylinder({of_a, pose_a}, {of_b, pose_b}, margin);
  }
  template <typename Other>
  Manifold operator()(const Mesh&, const Other&) const {
    return mesh_manifold(a, pose_a, b, pose_b, margin);
  }
  Manifold operator()(const Mesh&, const Sphere&) const {
    return turned(sphere_manifold(std::get<Sphere>(b.shape), pose_b.position, a, pose_a, margin));
  }
  template <typename First, typename Second>
  Manifold operator()(const First&, const Second&) const {
    return turned(std::visit(Pair{b, pose_b, a, pose_a, margin}, b.shape, a.shape));
  }
};

}  // namespace

ManifoldShape::ManifoldShape(const Shape& placed, const MeshCollider* collider)
    : shape(placed), mesh(collider), bounding_radius(mrhi::bounding_radius(placed)) {
  if (std::holds_alternative<Mesh>(placed) && collider == nullptr) {
    throw std::invalid_argument("a mesh needs its MeshCollider to be a ManifoldShape");
  }
}

Manifold body_manifold(const ManifoldShape& a, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin) {
  const double reach = a.bounding_radius + b.bounding_radius + margin;
  if ((pose_a.position - pose_b.position).squaredNorm() > reach * reach) return {};
  return std::visit(Pair{a, pose_a, b, pose_b, margin}, a.shape, b.shape);
}

}  // namespace mrhi
