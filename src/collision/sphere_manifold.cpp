#include "sphere_manifold.h"

#include "contact_region.h"

namespace mrhi {
namespace {

struct Closest {
  const Capsule& capsule;
  const MeshCollider* mesh;
  double margin;

  std::optional<ClosestFeatures> operator()(const Sphere& s) const { return capsule_sphere(capsule, s); }
  std::optional<ClosestFeatures> operator()(const Box& b) const { return capsule_box(capsule, b); }
  std::optional<ClosestFeatures> operator()(const Cylinder& c) const { return capsule_cylinder(capsule, c); }
  std::optional<ClosestFeatures> operator()(const Mesh&) const { return mesh->closest(capsule, margin); }
};

}  // namespace

std::optional<ClosestFeatures> closest_on(const ManifoldShape& shape, const Capsule& capsule, double margin) {
  const std::optional<ClosestFeatures> features =
      std::visit(Closest{capsule, shape.mesh, margin}, shape.shape);
  if (!features || features->distance > margin) return std::nullopt;
  return features;
}

Manifold sphere_manifold(const Sphere& sphere, const Vector3& centre, const ManifoldShape& b,
                         const Pose& pose_b, double margin) {
  const Vector3 local = pose_b.to_local(centre);
  const auto features = closest_on(b, Capsule{local, local, sphere.radius}, margin);
  Manifold manifold;
  if (!features) return manifold;
  manifold.normal = pose_b.orientation * features->normal;
  const Vector3 midway = features->point + 0.5 * features->distance * features->normal;
  add_point(manifold, pose_b * midway, -features->distance, 0);
  return manifold;
}

}  // namespace mrhi
