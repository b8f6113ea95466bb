#pragma once

#include <vector>

#include "mr_hand_interaction/collision/closest_features.h"
#include "triangle.h"

namespace mrhi {

/// The surface of a triangle mesh, with the normals of its edges and vertices (Baerentzen & Aanaes 2005: the
/// angle-weighted normal at the nearest point tells inside from outside). Triangles without area are left
/// out; neighbours are those that share indices of vertices.
class MeshSurface {
 public:
  /// Where faces meet and the solid bulges.
  struct ConvexEdge {
    Vector3 start, along;
    Vector3 normal, other_normal;
  };

  explicit MeshSurface(const TriangleMesh& mesh);

  const std::vector<Triangle>& triangles() const { return triangles_; }
  const std::vector<ConvexEdge>& convex_edges() const { return convex_edges_; }
  bool closed() const { return closed_; }  ///< has an inside
  bool convex() const { return convex_; }
  bool in_bounds(const Vector3& place) const;
  /// Outward normal, of any length, of the part of the triangle that is nearest.
  const Vector3& normal(int triangle, const TriangleNearest& nearest) const;

 private:
  void find_normals(const TriangleMesh& mesh);
  void find_edges();
  void add_edge(const Triangle& triangle, std::size_t edge, const Triangle& other);

  std::vector<Triangle> triangles_;
  std::vector<std::array<int, 3>> corners_;
  std::vector<std::array<Vector3, 3>> edge_normals_;  // [triangle][edge]
  std::vector<Vector3> vertex_normals_;
  std::vector<ConvexEdge> convex_edges_;
  Vector3 min_, max_;
  bool closed_ = true, convex_ = true;
};

/// The shortest translation that takes a segment, which cuts the surface or lies inside, out by a face or a
/// convex edge; distance <= 0. Exact for a convex mesh. Elsewhere the way out has to lead through the face or
/// edge itself; what the segment meets farther on is not looked at. Where there is none: out by `fallback`'s
/// plane.
ClosestFeatures leave_mesh(const Segment& segment, const MeshSurface& surface, int fallback);

}  // namespace mrhi
