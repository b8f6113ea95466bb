#include "mesh_nearest.h"

#include <algorithm>
#include <limits>
#include <optional>

namespace mrhi {

/// The guess is measured first: its distance bounds the search from the start. Over a convex solid it may be
/// all.
MeshNearest::MeshNearest(const MeshSurface& surface, const MeshTree& tree, const Segment& segment,
                         double range, int guess)
    : surface_(surface), segment_(segment), range_(range), faces_(static_cast<int>(surface.faces().size())) {
  if (guess >= 0) {
    measure(guess, kAnyDistance);
    if (is_all()) return;
    search(tree, range_);
  } else {
    search(tree, kAnyDistance);
  }
}

MeshNearest::MeshNearest(const MeshSurface& surface, const Segment& segment, double range,
                         const NearParts& near)
    : surface_(surface), segment_(segment), range_(range), faces_(static_cast<int>(surface.faces().size())) {
  for (std::size_t i = 0; i < near.count; ++i) measure(near.parts[i], kAnyDistance);
}

bool MeshNearest::is_all() const {
  return surface_.convex() && part() >= 0 && nearest().distance > kOnSurface &&
         surface_.is_support(nearest(), gap());
}

/// Branch and bound, the nearer child first: a node has nothing within `limit` of the segment where its box
/// is farther from the segment's. kRounding keeps parts at the limit itself.
template <typename Limit, typename See>
void MeshNearest::visit(const MeshTree& tree, const Limit& limit, const See& see) const {
  constexpr double kRounding = 1e-12;  // [m]
  struct Open {
    int node;
    double squared;  // from the node's box to the segment's
  };
  const Vector3 middle = segment_.middle(), half = 0.5 * segment_.along.cwiseAbs();
  const auto look = [&](int node) -> Open { return {node, tree.node(node).squared_gap(middle, half)}; };
  std::array<Open, MeshTree::kMaxLevels> open;
  std::size_t count = 0;
  open[count++] = look(0);
  while (count > 0) {
    const Open next = open[--count];
    const MeshTree::Node& node = tree.node(next.node);
    const double limit_now = limit(), reach = limit_now + kRounding;
    if (next.squared > reach * reach || is_below(node, limit_now)) continue;
    for (int i = node.first; i < node.first + node.count; ++i) see(tree.part(i));
    if (node.count > 0) continue;
    const Open one = look(node.first), other = look(node.first + 1);
    const bool one_first = one.squared <= other.squared;
    open[count++] = one_first ? other : one;
    open[count++] = one_first ? one : other;
  }
}

/// The limit shrinks as nearer parts are found: it is evaluated at every node.
void MeshNearest::search(const MeshTree& tree, double range) {
  visit(
      tree,
      [&] {
        ++visits_;
        return limit(range);
      },
      [&](int part) {
        ++visits_;
        measure(part, range);
      });
}

/// Parts that may be the nearest one while the segment's ends have not moved by more than `margin`. A motion
/// of s changes no distance by more than s. With d the nearest's distance and b that of the nearest part that
/// is left out, margin = (b - d) / 2. A face that is nearest at its border comes with the edges there. Faces
/// beyond the first 28 and edges beyond the nearest 12 bring b down.
NearParts MeshNearest::near_parts(const MeshTree& tree) const {
  constexpr std::size_t kEdgesKept = 12, kFacesKept = NearParts::kCapacity - kEdgesKept;
  constexpr double kMaxMargin = 1e-4, kRounding = 1e-9;
  struct Near {
    double distance;
    int part;
  };
  std::array<Near, kEdgesKept + 1> edges;
  std::array<Near, kFacesKept> faces;
  std::size_t edge_count = 0, face_count = 0;
  double bound = nearest().distance + 2.0 * kMaxMargin;
  const auto before = [](const Near& a, const Near& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.part < b.part;
  };
  visit(
      tree, [&] { return bound; },
      [&](int part) {
        if (is_too_far(part, bound)) return;
        const bool is_face = part < faces_;
        const SurfaceNearest now = measured(part);
        if (now.distance >= bound) return;
        if (is_face) {
          if (face_count < kFacesKept) {
            faces[face_count++] = {now.distance, part};
          } else {
            bound = std::min(bound, now.distance);
          }
          return;
        }
        std::size_t place = edge_count++;
        for (; place > 0 && before({now.distance, part}, edges[place - 1]); --place)
          edges[place] = edges[place - 1];
        edges[place] = {now.distance, part};
        if (edge_count > kEdgesKept) bound = edges[--edge_count].distance;
      });
  NearParts near;
  const auto add = [&](int part) {
    const auto end = near.parts.begin() + near.count;
    if (std::find(near.parts.begin(), end, part) != end) return;
    if (near.count < NearParts::kCapacity) near.parts[near.count] = part;
    ++near.count;
  };
  std::sort(faces.begin(), faces.begin() + face_count, before);
  for (std::size_t i = 0; i < face_count; ++i)
    if (faces[i].distance < bound) add(faces[i].part);
  for (std::size_t i = 0; i < edge_count; ++i) {
    if (edges[i].distance >= bound) continue;
    add(edges[i].part);
    for (const int face : surface_.edges()[edges[i].part - faces_].faces) add(face);
  }
  if (near.count > NearParts::kCapacity) return {};
  near.margin = std::max(0.0, 0.5 * (bound - nearest().distance) - kRounding);
  return near;
}

/// Seen along the direction f from the nearest so far to the segment, no part of the node is near enough. The
/// node lies in its ball, cut by two planes across its normal n: no point of it is higher along f than
/// f.c + (f.n) top + sin(f, n) r, while the segment's lowest point is at `least`.
bool MeshNearest::is_below(const MeshTree::Node& node, double limit) const {
  const double along = facing_.dot(node.normal);
  const double slab = along > 0.0 ? along * node.top : -along * node.bottom;
  const double below = min_height_ - limit - facing_.dot(node.centre) - slab;
  return below > 0.0 && below * below > (1.0 - along * along) * node.radius * node.radius;
}

/// A quick look before the part is measured: by the heights of the segment's ends over a face's plane, or of
/// an edge along f.
bool MeshNearest::is_too_far(int part, double limit) const {
  if (part < faces_) {
    const MeshSurface::Face& face = surface_.faces()[part];
    const double start = face.normal.dot(segment_.start) - face.height;
    const double end = start + face.normal.dot(segment_.along);
    return std::min(start, end) > limit || std::max(start, end) < -limit;
  }
  const MeshSurface::Edge& edge = surface_.edges()[part - faces_];
  return min_height_ - facing_.dot(edge.start) - std::max(0.0, facing_.dot(edge.along)) > limit;
}

SurfaceNearest MeshNearest::measured(int part) const {
  return part < faces_ ? surface_.nearest_on_face(part, segment_)
                       : surface_.nearest_on_edge(part - faces_, segment_);
}

/// Ties go to the lesser number, whichever was measured first.
void MeshNearest::measure(int part, double range) {
  if (is_too_far(part, limit(range))) return;
  const bool is_face = part < faces_;
  const SurfaceNearest now = measured(part);
  SurfaceNearest& best = is_face ? on_face_ : on_edge_;
  int& best_part = is_face ? face_ : edge_;
  if (now.distance > best.distance || (now.distance == best.distance && part > best_part)) return;
  const bool nearer = now.distance < limit(kAnyDistance);
  best = now, best_part = part;
  if (nearer) face_nearest();
}

/// Below 1 um the gap has no direction that would be worth a bound: f is 0, and is_below and is_too_far then
/// never leave anything out by it.
void MeshNearest::face_nearest() {
  const double distance = nearest().distance;
  facing_.setZero(), min_height_ = 0.0;
  if (distance < 1e-6) return;
  facing_ = gap() / distance;
  min_height_ = std::min(facing_.dot(segment_.start), facing_.dot(segment_.end()));
}

namespace {

struct Exit {
  double separation = -1e300;
  Vector3 normal = Vector3::UnitZ();
  Interval stretch{0.5, 0.5};  // of the segment, that comes out last
  bool through = false;        // the face itself, not only its plane
  int face = -1;
};

/// Along n the segment leaves the plane n.x = height by -separation, with
///     separation = min over s of n.a(s) - height = n.start - height + min(rise, 0),
/// and the end with the lesser n.a comes out last: the start if the segment rises, all of it if it is
/// parallel.
/// A segment on the border of a face comes out there, whatever rounding says: flush sides of equal meshes.
Exit exit_distance(const Segment& segment, const MeshSurface& surface, int index) {
  constexpr double kBorder = 1e-9;  // [m]
  const MeshSurface::Face& face = surface.faces()[index];
  const double rise = face.normal.dot(segment.along);
  Exit exit;
  exit.face = index;
  exit.separation = face.normal.dot(segment.start) - face.height + std::min(rise, 0.0);
  exit.normal = face.normal;
  exit.stretch = {rise > -kParallel ? 0.0 : 1.0, rise < kParallel ? 1.0 : 0.0};
  const auto through = [&](double border) {
    const Interval over = surface.over(face, segment, exit.stretch.middle(), border);
    return Interval{std::max(over.s0, exit.stretch.s0), std::min(over.s1, exit.stretch.s1)};
  };
  const Interval within = through(0.0), reached = through(kBorder);
  exit.through = reached.s0 <= reached.s1;
  if (exit.through) exit.stretch = within.s0 <= within.s1 ? within : reached;
  return exit;
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

class ExitSearch {
 public:
  ExitSearch(const Segment& segment, const MeshSurface& surface, double known)
      : segment_(segment), surface_(surface), known_(known) {}

  bool found() const { return face_.face >= 0 || edge_.part >= 0; }

  /// Lower bound of a node's depth.
  double cost(const MeshTree::Node& node) const {
    const double depth = node.depth(segment_);
    if (surface_.convex()) return depth;
    return node.may_be_exit(segment_) ? std::max(depth, node.distance(segment_)) : kUnreachable;
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
    if (face_.face < 0) face_ = exit_distance(segment_, surface_, fallback);
    const double s = face_.stretch.middle();
    return {face_.separation, face_.normal, segment_.at(s) - face_.separation * face_.normal, s, face_.face};
  }

 private:
  static constexpr double kUnreachable = std::numeric_limits<double>::infinity();  // beyond any limit

  /// A convex solid has every plane as a bound, also from outside by rounding. Elsewhere a face that the
  /// segment is above is no exit.
  bool allowed(double separation) const { return surface_.convex() || separation < kOnSurface; }
  void see_face(int index) {
    const MeshSurface::Face& face = surface_.faces()[index];
    const double separation =
        face.normal.dot(segment_.start) - face.height + std::min(face.normal.dot(segment_.along), 0.0);
    const bool better =
        separation > face_.separation || (separation == face_.separation && index < face_.face);
    if (!better || !allowed(separation)) return;
    const Exit exit = exit_distance(segment_, surface_, index);
    if (surface_.convex() || exit.through) face_ = exit;
  }
  void see_edge(int index) {
    const MeshSurface::Edge& edge = surface_.edges()[index];
    if (!edge.bulges) return;
    const auto exit = leave_by_edge(segment_, surface_, edge);
    if (!exit || !allowed(exit->distance)) return;
    const int part = static_cast<int>(surface_.faces().size()) + index;
    const bool better =
        exit->distance > edge_.distance || (exit->distance == edge_.distance && part < edge_.part);
    if (better) edge_ = *exit, edge_.part = part;
  }

  const Segment& segment_;
  const MeshSurface& surface_;
  const double known_;
  Exit face_;
  ClosestFeatures edge_{-1e300, Vector3::UnitZ(), Vector3::Zero(), 0.5};
};

}  // namespace

/// Of a convex solid the greatest separation of all faces and edges is the least translation (ConvexAxis has
/// the argument); the tree finds the least depth by best first.
ClosestFeatures leave_mesh(const Segment& segment, const MeshSurface& surface, const MeshTree& tree,
                           int fallback, const ClosestFeatures* known) {
  ExitSearch search(segment, surface, known == nullptr ? -1e300 : known->distance);
  tree.search([&](const MeshTree::Node& node) { return search.cost(node); }, [&] { return search.limit(); },
              [&](int part) { search.see(part); });
  if (known != nullptr && !search.found()) return *known;
  const ClosestFeatures best = search.result(fallback);
  return known != nullptr && known->distance > best.distance + kParallel ? *known : best;
}

}  // namespace mrhi
