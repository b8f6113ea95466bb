#pragma once

#include <memory>
#include <vector>

#include "body_manifold.h"
#include "mr_hand_interaction/scene/scene.h"
#include "placed_collider.h"

namespace mrhi {

/// What collision makes of a scene's shapes, once, at loading. Refers to the scene. Its parts refer to shapes
/// in the scene and to meshes behind pointers, not to each other's places in these lists, which may grow.
struct SceneGeometry {
  explicit SceneGeometry(const Scene& scene);

  std::vector<std::vector<std::shared_ptr<const MeshCollider>>>
      meshes;                                          ///< [body][shape], null unless a mesh
  std::vector<std::vector<ManifoldShape>> shapes;      ///< [body][shape]
  std::vector<std::vector<PlacedCollider>> colliders;  ///< [body][shape], for hands
};

}  // namespace mrhi
