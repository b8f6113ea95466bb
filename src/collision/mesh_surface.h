#pragma once

#include <cstddef>
#include <vector>

#include "closest_features.h"
#include "mr_hand_interaction/scene/shape.h"
#include "segment.h"

namespace mrhi {

/// A surface as its flat faces, however these are cut into triangles in a file: a polygon each, with corners
/// where it bends. Depends on the surface alone, not on the order of its triangles and vertices.
struct FlatFaces {
  struct Face {
    Vector3 normal;            ///< unit
    double height;             ///< of the plane above the origin, along the normal [m]
    int first = 0, count = 0;  ///< sides in MeshSurface
    bool convex = true;
  };
  /// A straight line from corner to corner, with the first face on its left, seen from outside.
  struct Edge {
    Vector3 start, along;
    std::array<int, 2> corners;
    std::array<int, 2> faces;  ///< equal at the border of an open surface
    bool bulges = false;       ///< the solid does, along it

    bool is_border() const { return faces[0] == faces[1]; }
  };

  std::vector<Vector3> corners;
  std::vector<Vector3> corner_normals;  ///< of any length: the sum of those around, by their angles
  std::vector<Face> faces;
  std::vector<Edge> edges;
  bool closed = true;
  bool one_piece = true;
};

/// Largest distance of a point on a plane or a line, as a fraction of the mesh's extent: vertices are rounded
/// to floats, by 6e-8 of a coordinate. A mesh that is far from its origin, against its size, is cut into more
/// faces.
constexpr double kFlatness = 5e-7;

/// Merges the triangles of each plane into one face. Throws std::invalid_argument if no triangle has an area.
FlatFaces merge_coplanar_triangles(const TriangleMesh& mesh);

/// Kind of feature that a segment is nearest to.
enum class SurfacePart { face, edge, corner };

struct SurfaceNearest {
  double distance = 1e300;          ///< 0 where the segment goes through the surface [m]
  Interval stretch;                 ///< of the segment; s0 == s1 unless it is parallel
  Vector3 point = Vector3::Zero();  ///< of the surface, facing the stretch's middle
  SurfacePart part = SurfacePart::face;
  int index = -1;  ///< of the face, edge or corner
};

/// Part s0..s1 of a finger's axis on which its pad lies, and the longest part of it over one flat face.
struct Pad {
  double s0, s1, longest;
};

/// The surface of a triangle mesh: flat faces, the edges between them and their corners. Inside is where
/// N.(p - nearest) < 0, with N the face's normal, the sum of an edge's two or a corner's weighted by angles
/// (Baerentzen & Aanaes 2005): beside sharp corners the nearest face's own normal is wrong.
class MeshSurface {
 public:
  using Face = FlatFaces::Face;
  using Edge = FlatFaces::Edge;

  explicit MeshSurface(const TriangleMesh& mesh);

  const std::vector<Vector3>& corners() const { return corners_; }
  const std::vector<Face>& faces() const { return faces_; }
  const std::vector<Edge>& edges() const { return edges_; }
  bool closed() const { return closed_; }  ///< has an inside
  bool convex() const { return convex_; }
  const Eigen::AlignedBox3d& bounds() const { return bounds_; }
  /// True if no part of the segment is nearer than `reach` to the bounds.
  bool is_beyond(const Segment& segment, double reach) const {
    const Vector3 end = segment.end();
    return ((segment.start.cwiseMin(end) - bounds_.max()).array() > reach).any() ||
           ((bounds_.min() - segment.start.cwiseMax(end)).array() > reach).any();
  }
  std::array<Vector3, 2> normals(const Edge& edge) const {
    return {{faces_[edge.faces[0]].normal, faces_[edge.faces[1]].normal}};
  }
  int face_at_corner(int corner) const {
    const std::size_t first = first_edge_[corner];
    return edges_[edges_at_[first]].faces[0];
  }
  bool is_first_edge(int edge, int corner) const { return edges_at_[first_edge_[corner]] == edge; }
  /// Number of a part in a list of the faces, then the edges, then the corners.
  int number(const SurfaceNearest& part) const { return number(part.part, part.index); }
  int number(SurfacePart part, int index) const {
    const int faces = static_cast<int>(faces_.size());
    if (part == SurfacePart::face) return index;
    return faces + index + (part == SurfacePart::corner ? static_cast<int>(edges_.size()) : 0);
  }
  /// Calls `see(corner)` for the corners around a face.
  template <typename See>
  void each_corner(const Face& face, const See& see) const {
    for (int i = face.first; i < face.first + face.count; ++i) {
      const Edge& edge = edges_[sides_[i].edge];
      for (const int corner : edge.corners) see(corners_[corner]);
    }
  }

  /// Interval of the segment straight above or below the face; the one around s if the face is not convex;
  /// empty (s0 > s1) if there is none. `border`: width by which the face is extended beyond its sides [m].
  Interval over(const Face& face, const Segment& segment, double s, double border = 0.0) const;
  /// Part of a capsule's axis on which its pad lies, around the deepest point: that of the features.
  Pad pad(const Segment& axis, const ClosestFeatures& deepest) const;
  /// Distance 1e300 if an edge of the face is nearer than its inside.
  SurfaceNearest nearest_on_face(int face, const Segment& segment) const;
  SurfaceNearest nearest_on_edge(int edge, const Segment& segment) const;

  /// Outward normal, of any length, where the surface is nearest.
  Vector3 outward(const SurfaceNearest& nearest) const;
  /// Largest cosine of the unit vector `direction` with the normals of the faces around a part, by its
  /// number, and with their sum.
  double alignment(int part, const Vector3& direction) const;
  /// True if the whole of a convex solid is below the plane through the nearest point, across `gap` (from
  /// there to the segment), and nothing but the part named is near that plane.
  bool is_support(const SurfaceNearest& nearest, const Vector3& gap) const;

 private:
  /// Of a face: outward in its plane, across an edge.
  struct Side {
    Vector3 outward;
    double reach;
    int edge;
  };
  void add_sides();
  void find_bends(bool one_piece);
  /// Calls `see(face)` for the faces around a part by its number: seen from a corner, those left of its
  /// edges.
  template <typename See>
  void each_face_around(int part, const See& see) const {
    const int edge = part - static_cast<int>(faces_.size()), corner = edge - static_cast<int>(edges_.size());
    if (edge < 0) return see(part);
    if (corner < 0) return see(edges_[edge].faces[0]), see(edges_[edge].faces[1]);
    for (std::size_t i = first_edge_[corner]; i < first_edge_[corner + 1]; ++i) {
      const Edge& of = edges_[edges_at_[i]];
      see(of.faces[of.corners[0] == corner ? 0 : 1]);
    }
  }
  /// The face around a part that a place beside it is over.
  int face_over(int part, const Vector3& place) const;
  bool is_convex(const Face& face) const;
  bool inside(const Face& face, const Vector3& place) const;
  bool on_side(const Face& face, const Vector3& place, double border) const;
  Interval around(const Face& face, const Segment& segment, double s, double border) const;

  std::vector<Vector3> corners_, corner_normals_;
  std::vector<Face> faces_;
  std::vector<Side> sides_;  // by face
  std::vector<Edge> edges_;
  std::vector<std::size_t> first_edge_;  // of a corner, in edges_at_
  std::vector<int> edges_at_;
  Eigen::AlignedBox3d bounds_;
  bool closed_ = true, convex_ = true;
};

}  // namespace mrhi
