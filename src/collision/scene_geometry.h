#pragma once

#include <memory>
#include <vector>

#include "body_manifold.h"
#include "closest_features.h"
#include "mesh_collision.h"
#include "mesh_tree.h"
#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// Closest features, in whose place anything of a distance beyond `margin` may stand where nothing is nearer
/// than that [m]. Capsule and features in the shape's frame; `mesh` is null unless the shape is one.
ClosestFeatures closest_on(const Shape& shape, const MeshCollider* mesh, const Capsule& capsule,
                           double margin);

/// A shape of a body as the hand's capsules meet it.
class PlacedCollider {
 public:
  /// Keeps references; `mesh` is null unless the shape is one.
  PlacedCollider(const PlacedShape& placed, const MeshCollider* mesh);

  ClosestFeatures closest(const Capsule& capsule, double margin) const {
    return closest_on(shape_, mesh_, capsule, margin);
  }
  bool has_bodys_frame() const { return has_bodys_frame_; }
  AxisSpan span(const Capsule& capsule, const ClosestFeatures& features) const {
    return mesh_ != nullptr ? mesh_->span(capsule, features) : contact_span(capsule, shape_, features);
  }

  /// Part of the axis on which the pad of a capsule lies: `span`, or over the faces beside an edge.
  AxisSpan pad(const Capsule& capsule, const ClosestFeatures& features) const;

  /// Transforms between the body's frame and the shape's.
  ///     x_shape = R^T (x_body - t),   n_body = R n_shape;   lengths, s and distance are the same in both
  /// Shapes that have the body's frame skip the rotation, which would only add rounding.
  Capsule to_shape(const Capsule& in_body) const {
    if (has_bodys_frame_) return in_body;
    return {rotation_.transpose() * (in_body.start - position_),
            rotation_.transpose() * (in_body.end - position_), in_body.radius};
  }
  /// Drops a mesh's part: call `span` in the shape's frame.
  ClosestFeatures to_body(const ClosestFeatures& in_shape) const {
    if (has_bodys_frame_) return in_shape;
    return {in_shape.distance, rotation_ * in_shape.normal, rotation_ * in_shape.point + position_,
            in_shape.axis_parameter};
  }

 private:
  const Shape& shape_;
  const MeshCollider* mesh_;
  const bool has_bodys_frame_;
  const Matrix3 rotation_;
  const Vector3 position_;
};

/// Colliders of a scene's shapes, created once at loading. Keeps references to the scene, its shapes and
/// meshes. No collider refers to another one's place in these lists, which may grow.
struct SceneGeometry {
  explicit SceneGeometry(const Scene& scene);

  std::vector<std::vector<std::shared_ptr<const MeshCollider>>>
      meshes;                                          ///< [body][shape], null unless a mesh
  std::vector<std::vector<ManifoldShape>> shapes;      ///< [body][shape]
  std::vector<std::vector<PlacedCollider>> colliders;  ///< [body][shape], for hands
};

}  // namespace mrhi
