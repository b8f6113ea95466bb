#include "mr_hand_interaction/collision/placed_collider.h"

namespace mrhi {
namespace {

/// A quick look before the closed form is asked: true if the capsule is beyond `margin` from a face's plane.
bool beside(const Capsule& capsule, const Box& box, double margin) {
  const Vector3 half_length = 0.5 * (capsule.end - capsule.start).cwiseAbs();
  const Vector3 gap = capsule.centre().cwiseAbs() - half_length - box.half_extents;
  return gap.maxCoeff() > margin + capsule.radius;
}

struct Closest {
  const Capsule& capsule;
  const MeshCollider* mesh;
  double margin;

  std::optional<ClosestFeatures> operator()(const Sphere& s) const { return capsule_sphere(capsule, s); }
  std::optional<ClosestFeatures> operator()(const Box& b) const {
    if (beside(capsule, b, margin)) return std::nullopt;
    return capsule_box(capsule, b);
  }
  std::optional<ClosestFeatures> operator()(const Cylinder& c) const { return capsule_cylinder(capsule, c); }
  std::optional<ClosestFeatures> operator()(const Mesh&) const { return mesh->closest(capsule, margin); }
};

}  // namespace

PlacedCollider::PlacedCollider(const PlacedShape& placed, const MeshCollider* mesh)
    : shape_(placed.shape),
      mesh_(mesh),
      has_bodys_frame_(placed.pose.position.isZero(0.0) && placed.pose.orientation.vec().isZero(0.0)),
      rotation_(placed.pose.orientation.toRotationMatrix()),
      position_(placed.pose.position) {}

std::optional<ClosestFeatures> PlacedCollider::closest(const Capsule& capsule, double margin) const {
  auto features = std::visit(Closest{capsule, mesh_, margin}, shape_);
  if (features && features->distance > margin) features.reset();
  return features;
}

}  // namespace mrhi
