#pragma once

#include <memory>
#include <vector>

#include "body_manifold.h"
#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// A shape of a body, placed in it. Keeps references.
class PlacedCollider : public ManifoldShape {
 public:
  /// `collider` is null unless the shape is a mesh.
  PlacedCollider(const PlacedShape& placed, const MeshCollider* collider);

  bool has_bodys_frame() const { return has_bodys_frame_; }

  /// Part of the axis on which the pad of a capsule lies: `span`, or over the faces beside an edge.
  AxisSpan pad(const Capsule& capsule, const ClosestFeatures& features) const;

  /// Transforms between the body's frame and the shape's. Shapes that have the body's frame skip the
  /// rotation, which would only add rounding.
  Capsule to_shape(const Capsule& in_body) const {
    if (has_bodys_frame_) return in_body;
    return {rotation_.transpose() * (in_body.start - pose.position),
            rotation_.transpose() * (in_body.end - pose.position), in_body.radius};
  }
  /// Drops a mesh's part: call `span` in the shape's frame.
  ClosestFeatures to_body(const ClosestFeatures& in_shape) const {
    if (has_bodys_frame_) return in_shape;
    return {in_shape.distance, rotation_ * in_shape.normal, rotation_ * in_shape.point + pose.position,
            in_shape.axis_parameter};
  }

  const Pose& pose;  ///< body frame

 private:
  const bool has_bodys_frame_;
  const Matrix3 rotation_;
};

/// Colliders of a scene's shapes, created once at loading. Keeps references to the scene, its shapes and
/// meshes. No collider refers to another one's place in these lists, which may grow.
struct SceneGeometry {
  explicit SceneGeometry(const Scene& scene);

  std::vector<std::shared_ptr<const MeshCollider>> meshes;  ///< that the colliders refer to
  std::vector<std::vector<PlacedCollider>> colliders;       ///< [body][shape]
};

}  // namespace mrhi
