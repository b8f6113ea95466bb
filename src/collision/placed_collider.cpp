#include "placed_collider.h"

#include <limits>

namespace mrhi {
namespace {

struct Closest {
  const Capsule& capsule;
  const MeshCollider* mesh;
  double margin;

  template <typename Asked>
  ClosestFeatures operator()(const Asked& shape) const {
    return shape.closest(capsule, margin);
  }
  ClosestFeatures operator()(const Mesh&) const {
    const auto features = mesh->closest(capsule, margin);
    if (features) return *features;
    return {std::numeric_limits<double>::infinity(), Vector3::UnitZ(), Vector3::Zero(), 0.0};
  }
};

}  // namespace

ClosestFeatures closest_on(const Shape& shape, const MeshCollider* mesh, const Capsule& capsule,
                           double margin) {
  return std::visit(Closest{capsule, mesh, margin}, shape);
}

PlacedCollider::PlacedCollider(const PlacedShape& placed, const MeshCollider* mesh)
    : shape_(placed.shape),
      mesh_(mesh),
      has_bodys_frame_(placed.pose.position.isZero(0.0) && placed.pose.orientation.vec().isZero(0.0)),
      rotation_(placed.pose.orientation.toRotationMatrix()),
      position_(placed.pose.position) {}

}  // namespace mrhi
