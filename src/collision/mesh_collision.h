#pragma once

#include <memory>
#include <optional>

#include "closest_features.h"

namespace mrhi {

struct MeshShape;

/// A triangle mesh prepared for contact: a tree of bounding volumes finds the faces and edges near a capsule,
/// closed forms measure them. Triangles in one plane (within 5e-7 of the mesh's extent) are one face, so that
/// nothing depends on how a file cuts a surface into triangles. A closed mesh is solid; an open one is a
/// sheet that touches from both sides. Threads and simulations may share a collider: it remembers recent
/// searches, but no result depends on that.
class MeshCollider {
 public:
  /// Throws std::invalid_argument if no triangle has an area.
  explicit MeshCollider(const TriangleMesh& mesh);
  ~MeshCollider();

  /// Closest features, if the capsule's surface is nearer than `margin` [m] to the mesh's, else nothing.
  /// Capsule in the mesh's frame. Exact outside a solid, and inside a convex one; with the axis inside a
  /// solid that is not convex, the shortest way out through what is nearest.
  std::optional<ClosestFeatures> closest(const Capsule& capsule, double margin) const;

  /// Part of the capsule's axis over the flat face that `closest` found; a point for an edge, a corner, or a
  /// face of a curved surface.
  AxisSpan span(const Capsule& capsule, const ClosestFeatures& features) const;

  /// Part of the axis on which the pad of a capsule lies that touches an edge, a corner or a facet; a point
  /// in its middle if no face under it is flat enough.
  AxisSpan pad(const Capsule& capsule, const ClosestFeatures& features) const;

  const MeshShape& shape() const;

  /// Mean work of a search near the surface, over that of an ordinary mesh; >= 1. Large for long thin faces.
  double search_cost() const;
  /// The same on the surface or this far below it [m]: all parts are about as near to the middle of a round
  /// solid.
  double deep_search_cost(double depth) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

/// The collider of `mesh`, shared by all scenes of the process that have this mesh: a change of a scene does
/// not prepare it again. Throws as the constructor does. Any thread may call it.
std::shared_ptr<const MeshCollider> shared_collider(const std::shared_ptr<const TriangleMesh>& mesh);

}  // namespace mrhi
