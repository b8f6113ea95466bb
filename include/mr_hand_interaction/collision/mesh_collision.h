#pragma once

#include <memory>
#include <optional>

#include "mr_hand_interaction/collision/closest_features.h"

namespace mrhi {

/// A triangle mesh prepared for contact: FCL's bounding volumes find the triangles near a capsule, closed
/// forms measure them. A closed mesh is solid, also where it is not convex; an open one is a sheet that
/// touches from both sides. Neighbouring triangles share indices of vertices. Immutable; shared between
/// threads and simulations.
class MeshCollider {
 public:
  /// Throws std::invalid_argument if no triangle has an area.
  explicit MeshCollider(const TriangleMesh& mesh);
  ~MeshCollider();

  /// Closest features, if the capsule's surface is nearer than `margin` [m] to the mesh's, else nothing.
  /// Capsule in the mesh's frame. Exact outside a solid, and inside a convex one; with the axis inside a
  /// solid that is not convex, the shortest way out through what is nearest.
  std::optional<ClosestFeatures> closest(const Capsule& capsule, double margin) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace mrhi
