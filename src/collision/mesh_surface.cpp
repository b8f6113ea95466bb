#include "mesh_surface.h"

#include "segment.h"

namespace mrhi {
namespace {

/// Largest bend of a flat edge [rad]. |n0 x n1| is the sine of the bend.
constexpr double kMaxFlatBend = 1e-6;
/// Smallest distance of a point from a border, as a fraction of the border's length, and of a gap from a
/// plane, as a fraction of its own length, that counts as clear.
constexpr double kMinClearance = 1e-5;
/// Shortest length over a face that can end a pad [m]; shorter ones are rounding beside an edge.
constexpr double kMinPadLength = 1e-6;

/// A segment seen along a normal n, on the surface under it. With q = along x n across it, a corner c is
/// q.(c - start) to one side of it.
struct Seen {
  Seen(const Segment& segment, const Vector3& normal)
      : start(segment.start), across(segment.along.cross(normal)), along(normal.cross(across)) {
    along /= along.squaredNorm();
  }
  /// Where it crosses an edge between two of these corners, 0..1 on the segment; nothing (2) if it passes it
  /// by. It crosses if the ends' signs differ. An end on the line counts as >= 0, and both edges at a corner
  /// find the same sign: a ray through a corner crosses one of them, or both or none.
  double crossing(const MeshSurface::Edge& edge, const std::vector<Vector3>& corners) const {
    const Vector3 &first = corners[edge.corners[0]], &second = corners[edge.corners[1]];
    const double from = across.dot(first - start), to = across.dot(second - start);
    if ((from < 0.0) == (to < 0.0)) return 2.0;
    return along.dot(first - start) - from / (to - from) * along.dot(second - first);
  }

  Vector3 start, across, along;
};

}  // namespace

MeshSurface::MeshSurface(const TriangleMesh& mesh) {
  FlatFaces flat = merge_coplanar_triangles(mesh);
  corners_ = std::move(flat.corners);
  corner_normals_ = std::move(flat.corner_normals);
  faces_ = std::move(flat.faces);
  edges_ = std::move(flat.edges);
  closed_ = flat.closed;
  for (const Vector3& corner : corners_) bounds_.extend(corner);
  add_sides();
  find_bends(flat.one_piece);
}

/// Edges have their first face on their left, seen from outside: along x n points out of it, in its plane;
/// round the other the edge runs the other way. `reach` is the side's plane, outward.x = reach; lengths are
/// those of the edges, not 1.
void MeshSurface::add_sides() {
  first_edge_.assign(corners_.size() + 1, 0);
  for (const Edge& edge : edges_) {
    ++faces_[edge.faces[0]].count;
    if (!edge.is_border()) ++faces_[edge.faces[1]].count;
    for (const int corner : edge.corners) ++first_edge_[corner + 1];
  }
  int first = 0;
  for (Face& face : faces_) face.first = first, first += face.count, face.count = 0;
  for (std::size_t c = 0; c < corners_.size(); ++c) first_edge_[c + 1] += first_edge_[c];
  sides_.resize(first);
  edges_at_.resize(2 * edges_.size());
  std::vector<std::size_t> next(first_edge_);
  for (int e = 0; e < static_cast<int>(edges_.size()); ++e) {
    const Edge& edge = edges_[e];
    const auto add = [&](int of, const Vector3& along) {
      Face& face = faces_[of];
      const Vector3 outward = along.cross(face.normal);
      sides_[face.first + face.count++] = {outward, outward.dot(edge.start), e};
    };
    add(edge.faces[0], edge.along);
    if (!edge.is_border()) add(edge.faces[1], -edge.along);
    for (const int corner : edge.corners) edges_at_[next[corner]++] = e;
  }
  for (Face& face : faces_) face.convex = is_convex(face);
}

/// sin bend = (n0 x n1).along / |along| with n0's face on the left: > 0 where the solid bulges. A closed
/// surface of one piece that bends inwards nowhere is convex as a whole (Tietze 1928, Nakajima 1928), unless
/// it cuts itself.
void MeshSurface::find_bends(bool one_piece) {
  convex_ = closed_ && one_piece;
  for (Edge& edge : edges_) {
    const std::array<Vector3, 2> normal = normals(edge);
    const double bend = normal[0].cross(normal[1]).dot(edge.along.normalized());
    edge.bulges = bend > kMaxFlatBend;
    convex_ = convex_ && bend > -kMaxFlatBend;
  }
}

/// No corner of it is beyond any of its sides, by more than its seams may be off a line at both ends.
bool MeshSurface::is_convex(const Face& face) const {
  if (face.count <= 3) return true;
  for (int i = face.first; i < face.first + face.count; ++i) {
    const Side& side = sides_[i];
    const double tolerance = 2.0 * kFlatness * bounds_.sizes().maxCoeff() * side.outward.norm();
    bool behind = true;
    each_corner(face,
                [&](const Vector3& c) { behind = behind && side.outward.dot(c) <= side.reach + tolerance; });
    if (!behind) return false;
  }
  return true;
}

/// By the number of sides that a ray from there crosses. An odd number is inside (Jordan); any direction
/// does.
bool MeshSurface::inside(const Face& face, const Vector3& place) const {
  const Seen ray(Segment(Capsule{place, place + any_normal(face.normal), 0.0}), face.normal);
  bool inside = false;
  for (int i = face.first; i < face.first + face.count; ++i) {
    const double s = ray.crossing(edges_[sides_[i].edge], corners_);
    if (s != 2.0 && s > 0.0) inside = !inside;
  }
  return inside;
}

/// Seen along the normal.
bool MeshSurface::on_side(const Face& face, const Vector3& place, double border) const {
  for (int i = face.first; i < face.first + face.count; ++i) {
    const Edge& edge = edges_[sides_[i].edge];
    const Vector3 apart = edge.start + foot(edge.start, edge.along, place) * edge.along - place;
    if ((apart - apart.dot(face.normal) * face.normal).squaredNorm() <= border * border) return true;
  }
  return false;
}

/// From the last crossing before s to the first after it.
Interval MeshSurface::around(const Face& face, const Segment& segment, double s, double border) const {
  if (!inside(face, segment.at(s)) && !(border > 0.0 && on_side(face, segment.at(s), border)))
    return {1.0, 0.0};
  Interval stretch;
  if (segment.along.isZero(0.0)) return stretch;
  const Seen seen(segment, face.normal);
  for (int i = face.first; i < face.first + face.count; ++i) {
    const double crosses = seen.crossing(edges_[sides_[i].edge], corners_);
    if (crosses <= s) stretch.s0 = std::max(stretch.s0, crosses);
    if (crosses > s) stretch.s1 = std::min(stretch.s1, crosses);
  }
  return stretch;
}

/// Of a convex face by its sides' half-planes, outward.(start + s along) <= reach (Cyrus & Beck 1978).
Interval MeshSurface::over(const Face& face, const Segment& segment, double s, double border) const {
  if (!face.convex) return around(face, segment, s, border);
  Interval stretch;
  for (int i = face.first; i < face.first + face.count; ++i) {
    const Side& side = sides_[i];
    const double beyond = border > 0.0 ? border * side.outward.norm() : 0.0;
    const double x0 = side.outward.dot(segment.start) - side.reach - beyond,
                 dx = side.outward.dot(segment.along);
    stretch.clip(x0, dx, 0.0);
    if ((dx == 0.0 && x0 > 0.0) || stretch.s0 > stretch.s1) return {1.0, 0.0};
  }
  return stretch;
}

/// A convex face by how far the place is beyond its sides.
int MeshSurface::face_over(int part, const Vector3& place) const {
  int best = -1;
  double least = 1e300;
  each_face_around(part, [&](int index) {
    const Face& face = faces_[index];
    double beyond = face.convex || inside(face, place) ? -1e300 : 1.0;
    for (int i = face.first; face.convex && i < face.first + face.count; ++i) {
      const Side& side = sides_[i];
      beyond = std::max(beyond, side.outward.dot(place) - side.reach);
    }
    if (beyond < least) least = beyond, best = index;
  });
  return best;
}

/// The pad has the depth D at the deepest point and D - rise elsewhere. The axis rises above each face under
/// it by n.along. The length of the pad to each side is
///     integral of max(0, 2 (D - rise) / D - 1) ds
/// It is the whole face without tilt, and the fraction 1 - rise / D of a face that ends with this rise. It is
/// continuous from facet to facet of a curved or rough surface. The pad ends at a face that is tilted by more
/// than kMaxTilt.
///
/// The faces are those under a line slightly beside the axis, because a symmetric body may have edges and
/// corners exactly under the axis.
Pad MeshSurface::pad(const Segment& axis, const ClosestFeatures& deepest) const {
  constexpr double kSideOffset = 1e-7, kForwardOffset = 0.6e-7;  // [m]
  constexpr int kMaxFaces = 64;
  const double length = axis.along.norm(), min_length = kMinPadLength / length;
  const Vector3& up = deepest.normal;
  const Vector3 aside = kSideOffset / length * up.cross(axis.along),
                on = kForwardOffset / length * axis.along;
  Seen line(axis, up);
  line.start += aside;
  const int first = face_over(deepest.part, deepest.point + aside + on);
  Pad pad{deepest.axis_parameter, deepest.axis_parameter, 0.0};
  for (const double side : {-1.0, 1.0}) {
    double s = deepest.axis_parameter + kForwardOffset / length, rise = 0.0;
    int index = first;
    for (int count = 0; index >= 0 && count < kMaxFaces; ++count) {
      const Face& face = faces_[index];
      double until = side > 0.0 ? 1.0 : 0.0;
      int next = -1;
      for (int i = face.first; i < face.first + face.count; ++i) {
        const Edge& edge = edges_[sides_[i].edge];
        const double crosses = line.crossing(edge, corners_);
        if (crosses == 2.0 || side * (crosses - s) <= 0.0 || side * (until - crosses) <= 0.0) continue;
        until = crosses;
        next = edge.is_border() ? -1 : edge.faces[edge.faces[0] == index ? 1 : 0];
      }
      const bool away = face.normal.dot(up) < 0.0;
      const double slope = away ? -face.normal.dot(axis.along) : face.normal.dot(axis.along);
      const double risen = rise + slope * (until - s), step = std::abs(until - s);
      const double tilt = face.normal.cross(up).norm();
      const double lifted = std::max(std::max(rise + risen, 0.0) / -deepest.distance, tilt / kMaxTilt);
      if (step > min_length && (lifted >= 1.0 || (closed_ && away))) break;
      const double lies = std::max(0.0, 1.0 - lifted) * step;
      (side < 0.0 ? pad.s0 : pad.s1) += side * lies;
      pad.longest = std::max(pad.longest, lies);
      rise = risen, s = until, index = next;
    }
  }
  return pad;
}

/// The height above the plane, n.start - height + s rise, is 0 at the crossing; held in 0..1 that is the
/// segment's place nearest to the plane. If it is straight above the face it is the nearest of all; if not,
/// an edge or a corner is nearer to the segment, and found by itself.
SurfaceNearest MeshSurface::nearest_on_face(int index, const Segment& segment) const {
  const Face& face = faces_[index];
  SurfaceNearest found;
  const double height = face.normal.dot(segment.start) - face.height, rise = face.normal.dot(segment.along);
  const bool parallel = std::abs(rise) < kParallel;
  const double crossing = -height / rise;
  const bool crosses = !parallel && crossing >= 0.0 && crossing <= 1.0;
  double s = parallel ? 0.5 : clamp_unit(crossing);
  Interval above = over(face, segment, s);
  if (above.s0 > above.s1) return found;
  if (parallel) {
    s = above.middle();
  } else if (s < above.s0 || s > above.s1) {
    return found;
  } else {
    above = {s, s};
  }
  const double level = height + s * rise;
  found.stretch = above;
  found.distance = crosses ? 0.0 : std::abs(level);
  found.point = segment.at(s) - level * face.normal;
  found.index = index;
  return found;
}

SurfaceNearest MeshSurface::nearest_on_edge(int index, const Segment& segment) const {
  const Edge& edge = edges_[index];
  const SegmentPair nearest = nearest_points(segment, edge.start, edge.along);
  SurfaceNearest found;
  if (nearest.t <= 0.0 || nearest.t >= 1.0) {
    // The same for all edges that end here.
    found.part = SurfacePart::corner;
    found.index = edge.corners[nearest.t >= 1.0 ? 1 : 0];
    found.point = corners_[found.index];
    const double s = foot(segment.start, segment.along, found.point);
    found.stretch = {s, s};
  } else {
    found.part = SurfacePart::edge;
    found.index = index;
    found.point = edge.start + nearest.t * edge.along;
    found.stretch = nearest.stretch;
  }
  found.distance = (segment.at(found.stretch.middle()) - found.point).norm();
  return found;
}

Vector3 MeshSurface::outward(const SurfaceNearest& nearest) const {
  if (nearest.part == SurfacePart::face) return faces_[nearest.index].normal;
  if (nearest.part == SurfacePart::corner) return corner_normals_[nearest.index];
  const std::array<Vector3, 2> normal = normals(edges_[nearest.index]);
  return normal[0] + normal[1];
}

double MeshSurface::alignment(int part, const Vector3& direction) const {
  double largest = -1.0;
  Vector3 sum = Vector3::Zero();
  each_face_around(part, [&](int face) {
    largest = std::max(largest, faces_[face].normal.dot(direction));
    sum += faces_[face].normal;
  });
  return std::max(largest, sum.normalized().dot(direction));
}

/// Over a convex solid it is enough to look about the part itself: a face whose inside is nearest, from
/// above; an edge with the gap between its faces' normals, gap.(along x n0) > 0 and gap.(n1 x along) > 0; a
/// corner from which all edges go down, -along.gap > 0. Then the plane across the gap supports the solid
/// (what is locally so is so everywhere), and nothing is nearer. What is nearly on the next part is not
/// certain: it has to be searched, so that ties go as they always do.
bool MeshSurface::is_support(const SurfaceNearest& nearest, const Vector3& gap) const {
  const double clear = kMinClearance * nearest.distance;
  if (nearest.part == SurfacePart::face) {
    const Face& face = faces_[nearest.index];
    if (face.normal.dot(gap) <= 0.0) return false;
    for (int i = face.first; i < face.first + face.count; ++i) {
      const Side& side = sides_[i];
      if (side.outward.dot(nearest.point) - side.reach > -kMinClearance * side.outward.squaredNorm())
        return false;
    }
    return true;
  }
  if (nearest.part == SurfacePart::edge) {
    const Edge& edge = edges_[nearest.index];
    const double length = edge.along.norm();
    const double t = edge.along.dot(nearest.point - edge.start) / (length * length);
    const std::array<Vector3, 2> normal = normals(edge);
    return t > kMinClearance && t < 1.0 - kMinClearance &&
           edge.along.cross(normal[0]).dot(gap) > clear * length &&
           normal[1].cross(edge.along).dot(gap) > clear * length;
  }
  const std::size_t corner = nearest.index;
  for (std::size_t i = first_edge_[corner]; i < first_edge_[corner + 1]; ++i) {
    const Edge& edge = edges_[edges_at_[i]];
    const double down = edge.corners[0] == nearest.index ? -edge.along.dot(gap) : edge.along.dot(gap);
    if (down < clear * edge.along.norm()) return false;
  }
  return true;
}

}  // namespace mrhi
