#include "mr_hand_interaction/collision/placed_collider.h"

#include <limits>

namespace mrhi {
namespace {

/// A quick look before the closed form is asked: true if the capsule is beyond `margin` from a face's plane.
bool beside(const Capsule& capsule, const Box& box, double margin) {
  const Vector3 half_length = 0.5 * (capsule.end - capsule.start).cwiseAbs();
  const Vector3 gap = capsule.centre().cwiseAbs() - half_length - box.half_extents;
  return gap.maxCoeff() > margin + capsule.radius;
}

ClosestFeatures far_away() {
  return {std::numeric_limits<double>::infinity(), Vector3::UnitZ(), Vector3::Zero(), 0.0};
}

struct Closest {
  const Capsule& capsule;
  const MeshCollider* mesh;
  double margin;

  ClosestFeatures operator()(const Sphere& s) const { return capsule_sphere(capsule, s); }
  ClosestFeatures operator()(const Box& b) const {
    return beside(capsule, b, margin) ? far_away() : capsule_box(capsule, b);
  }
  ClosestFeatures operator()(const Cylinder& c) const { return capsule_cylinder(capsule, c); }
  ClosestFeatures operator()(const Mesh&) const {
    const auto features = mesh->closest(capsule, margin);
    return features ? *features : far_away();
  }
};

}  // namespace

PlacedCollider::PlacedCollider(const PlacedShape& placed, const MeshCollider* mesh)
    : shape_(placed.shape),
      mesh_(mesh),
      has_bodys_frame_(placed.pose.position.isZero(0.0) && placed.pose.orientation.vec().isZero(0.0)),
      rotation_(placed.pose.orientation.toRotationMatrix()),
      position_(placed.pose.position) {}

ClosestFeatures PlacedCollider::closest(const Capsule& capsule, double margin) const {
  return std::visit(Closest{capsule, mesh_, margin}, shape_);
}

}  // namespace mrhi
