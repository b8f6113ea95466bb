#pragma once

#include <memory>
#include <optional>

#include "mr_hand_interaction/collision/closest_features.h"

namespace mrhi {

/// A triangle mesh prepared for contact: FCL's bounding volumes find the triangles near a capsule, closed
/// forms measure them. Immutable; shared between threads and simulations.
class MeshCollider {
 public:
  explicit MeshCollider(const TriangleMesh& mesh);
  ~MeshCollider();

  /// Closest features, if the capsule's surface is nearer than `margin` [m] to the mesh's, else nothing.
  /// Capsule in the mesh's frame.
  std::optional<ClosestFeatures> closest(const Capsule& capsule, double margin) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace mrhi
