#include "mesh_nearest.h"

#include <limits>
#include <optional>

namespace mrhi {
namespace {

struct WayOut {
  double separation = -1e300;
  Vector3 normal = Vector3::UnitZ();
  Stretch stretch{0.5, 0.5};  // of the segment, that comes out last
  bool through = false;       // the face itself, not only its plane
  int face = -1;
};

/// Along n the segment leaves the plane n.x = height by -separation, with
///     separation = min over s of n.a(s) - height = n.start - height + min(rise, 0),
/// and the end with the lesser n.a comes out last: the start if the segment rises, all of it if it is
/// parallel.
WayOut way_out(const Segment& segment, const MeshSurface& surface, int index) {
  const MeshSurface::Face& face = surface.faces()[static_cast<std::size_t>(index)];
  const double rise = face.normal.dot(segment.along);
  WayOut way;
  way.face = index;
  way.separation = face.normal.dot(segment.start) - face.height + std::min(rise, 0.0);
  way.normal = face.normal;
  way.stretch = {rise > -kParallel ? 0.0 : 1.0, rise < kParallel ? 1.0 : 0.0};
  const Stretch over = surface.over(face, segment, way.stretch.middle());
  const Stretch through{std::max(over.s0, way.stretch.s0), std::min(over.s1, way.stretch.s1)};
  way.through = through.s0 <= through.s1;
  if (way.through) way.stretch = through;
  return way;
}

/// Across the segment and the edge, if that is a direction between those of the edge's faces. Seen along it,
/// the two cross where the segment comes out. The solid swept along the segment has a face that the edge
/// sweeps where the arc between n0 and n1, on the sphere of directions, crosses the circle n.along = 0: r0 =
/// n0.along and r1 = n1.along have opposite signs, and n is along |r1| n0 + |r0| n1. All of the segment is at
/// the same height n.(a - edge), < 0, over the edge. With the segment moved out by that, the crossing is at
///     s a - t b = d,   s b - t c = e,   a = along^2, b = along.edge, c = edge^2,
/// d and e the offset along either.
std::optional<ClosestFeatures> leave_by_edge(const Segment& segment, const MeshSurface& surface,
                                             const MeshSurface::Edge& edge) {
  const std::array<Vector3, 2> normals = surface.normals(edge);
  const double rise = normals[0].dot(segment.along), other_rise = normals[1].dot(segment.along);
  if (rise * other_rise >= 0.0) return std::nullopt;
  const Vector3 normal = (std::abs(other_rise) * normals[0] + std::abs(rise) * normals[1]).normalized();
  const double separation = normal.dot(segment.middle() - edge.start);
  const Vector3 offset = edge.start + separation * normal - segment.start;
  const double a = segment.along.squaredNorm(), b = segment.along.dot(edge.along),
               c = edge.along.squaredNorm();
  const double d = segment.along.dot(offset), e = edge.along.dot(offset);
  const double determinant = a * c - b * b;
  if (determinant <= 0.0) return std::nullopt;
  const double s = (d * c - b * e) / determinant, t = (b * d - a * e) / determinant;
  const double s_held = std::max(0.0, std::min(s, 1.0)), t_held = std::max(0.0, std::min(t, 1.0));
  if (!surface.convex() && (s != s_held || t != t_held)) return std::nullopt;
  return ClosestFeatures{separation, normal, edge.start + t_held * edge.along, s_held};
}

class WayOutSearch {
 public:
  WayOutSearch(const Segment& segment, const MeshSurface& surface, double known)
      : segment_(segment), surface_(surface), known_(known) {}

  bool found() const { return face_.face >= 0 || edge_index_ >= 0; }

  /// How deep a node is at least. Where the way has to lead through a part, that is no farther than it is
  /// deep.
  double cost(const MeshTree::Node& node) const {
    const double depth = node.depth(segment_);
    if (surface_.convex()) return depth;
    return node.may_be_way_out(segment_) ? std::max(depth, node.distance(segment_)) : kNoWay;
  }
  /// Less the best separation is the least depth so far; 1e-9 keeps ties, which the numbers decide.
  double limit() const { return -std::max({face_.separation, edge_.distance, known_}) + 1e-9; }
  void see(int part) {
    const int faces = static_cast<int>(surface_.faces().size());
    part < faces ? see_face(part) : see_edge(part - faces);
  }

  /// Faces come before edges, and the first of those that are as deep.
  ClosestFeatures result(int fallback) {
    if (edge_.distance > face_.separation + kParallel) return edge_;
    if (face_.face < 0) face_ = way_out(segment_, surface_, fallback);
    const double s = face_.stretch.middle();
    return {face_.separation, face_.normal, segment_.at(s) - face_.separation * face_.normal, s, face_.face};
  }

 private:
  static constexpr double kNoWay = std::numeric_limits<double>::infinity();  // beyond any limit

  /// A convex solid has every plane as a bound, also from outside by rounding. Elsewhere a face that the
  /// segment is above is no way out.
  bool allowed(double separation) const { return surface_.convex() || separation < kOnSurface; }
  void see_face(int index) {
    const MeshSurface::Face& face = surface_.faces()[static_cast<std::size_t>(index)];
    const double separation =
        face.normal.dot(segment_.start) - face.height + std::min(face.normal.dot(segment_.along), 0.0);
    const bool better =
        separation > face_.separation || (separation == face_.separation && index < face_.face);
    if (!better || !allowed(separation)) return;
    const WayOut way = way_out(segment_, surface_, index);
    if (surface_.convex() || way.through) face_ = way;
  }
  void see_edge(int index) {
    const MeshSurface::Edge& edge = surface_.edges()[static_cast<std::size_t>(index)];
    if (!edge.bulges) return;
    const auto way = leave_by_edge(segment_, surface_, edge);
    if (!way || !allowed(way->distance)) return;
    const bool better =
        way->distance > edge_.distance || (way->distance == edge_.distance && index < edge_index_);
    if (better) edge_ = *way, edge_index_ = index;
  }

  const Segment& segment_;
  const MeshSurface& surface_;
  const double known_;
  WayOut face_;
  ClosestFeatures edge_{-1e300, Vector3::UnitZ(), Vector3::Zero(), 0.5};
  int edge_index_ = -1;
};

}  // namespace

/// Of a convex solid the greatest separation of all faces and edges is the least translation (ConvexAxis has
/// the argument); the tree finds the least depth by best first.
ClosestFeatures leave_mesh(const Segment& segment, const MeshSurface& surface, const MeshTree& tree,
                           int fallback, const ClosestFeatures* known) {
  WayOutSearch search(segment, surface, known == nullptr ? -1e300 : known->distance);
  tree.search([&](const MeshTree::Node& node) { return search.cost(node); }, [&] { return search.limit(); },
              [&](int part) { search.see(part); });
  if (known != nullptr && !search.found()) return *known;
  const ClosestFeatures best = search.result(fallback);
  return known != nullptr && known->distance > best.distance + kParallel ? *known : best;
}

}  // namespace mrhi
