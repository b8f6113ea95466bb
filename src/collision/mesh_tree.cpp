#include "mesh_tree.h"

#include <algorithm>
#include <numeric>

namespace mrhi {
namespace {

constexpr int kMaxLeafParts = 4;

/// Calls `place(p)` for what spans a part, `normal(n)` for the directions that it faces.
template <typename Place, typename Normal>
void span(const MeshSurface& surface, int part, const Place& place, const Normal& normal) {
  const int faces = static_cast<int>(surface.faces().size());
  if (part < faces) {
    const MeshSurface::Face& face = surface.faces()[part];
    surface.each_corner(face, place);
    normal(face.normal);
  } else {
    const MeshSurface::Edge& edge = surface.edges()[part - faces];
    for (const int corner : edge.corners) place(surface.corners()[corner]);
    for (const Vector3& n : surface.normals(edge)) normal(n);
  }
}

}  // namespace

/// Its ball: |c - a(s)| - r at the foot s of c.
double MeshTree::Node::distance(const Segment& segment) const {
  return (centre - segment.start - foot(segment.start, segment.along, centre) * segment.along).norm() -
         radius;
}

/// A part with the normal m through p is m.(p - e) above the end e. With theta <= spread the angle between m
/// and the node's n:
///     m.(p - e) = m.(c - e) + m.(p - c) >= least - (cos theta bottom + sin theta r),
/// of which cos theta <= 1 and sin theta <= sin spread. Least is |c - e| cos(phi + spread) with phi the angle
/// of c - e from n. What comes out last is the deeper end: the greater of both bounds.
double MeshTree::Node::depth(const Segment& segment) const {
  if (cos_spread <= 0.0) return -1e300;
  double depth = -1e300;
  for (const Vector3& end : {segment.start, segment.end()}) {
    const Vector3 offset = centre - end;
    const double up = normal.dot(offset);
    const double aside = std::sqrt(std::max(0.0, offset.squaredNorm() - up * up));
    // Of directions within the cone the least along the offset; beyond its opposite that is -|offset|.
    const double lowest =
        up * sin_spread < -aside * cos_spread ? -offset.norm() : up * cos_spread - aside * sin_spread;
    depth = std::max(depth, lowest - bottom - radius * sin_spread);
  }
  return depth;
}

/// A way out from x to a place p of a part goes along its normal m, at the angle theta <= spread from n: p -
/// x = lambda m. Across n and along it
///     |(c - x) across| <= lambda sin theta + |(c - p) across|,   lambda cos theta = n.(c - x) - n.(c - p),
/// so that, times cos theta, |(c - x) across| cos theta <= n.(c - x) sin theta + r, as (sin theta, cos theta)
/// is a unit vector and |c - p| <= r. At the greatest theta, and the greatest n.(c - x) of what may come out
/// last, this is the widest.
bool MeshTree::Node::may_be_exit(const Segment& segment) const {
  if (cos_spread <= 0.1) return true;
  const double rise = normal.dot(segment.along), swing = sin_spread * segment.along.norm() + kParallel;
  // Of normals that all rise along the segment its start comes out last, of those that fall its end; else any
  // place.
  const double s0 = rise < -swing ? 1.0 : 0.0, s1 = rise > swing ? 0.0 : 1.0;
  const Vector3 offset = centre - segment.at(s0), along = (s1 - s0) * segment.along;
  const double up = normal.dot(offset), run_up = normal.dot(along);
  const Vector3 aside = offset - up * normal, run = along - run_up * normal;
  const double squared = run.squaredNorm();
  const double s = squared > 0.0 ? std::max(0.0, std::min(aside.dot(run) / squared, 1.0)) : 0.0;
  const double highest = std::max(0.0, std::max(up, up - run_up));
  return (aside - s * run).norm() * cos_spread <= highest * sin_spread + radius;
}

MeshTree::MeshTree(const MeshSurface& surface) : parts_(surface.faces().size() + surface.edges().size()) {
  std::iota(parts_.begin(), parts_.end(), 0);
  std::vector<Vector3> centres;
  for (const int part : parts_) {
    Eigen::AlignedBox3d box;
    span(
        surface, part, [&](const Vector3& p) { box.extend(p); }, [](const Vector3&) {});
    centres.emplace_back(box.center());
  }
  nodes_.reserve(parts_.size());
  nodes_.emplace_back();
  build(surface, 0, centres, 0, static_cast<int>(parts_.size()));
}

/// Halves by the median along the longest side of the box of the parts' middles, so that the tree is no
/// deeper than log2 of their number. Equal places go by number, so that the tree, and the order of all that
/// it finds, is the surface's own. The node is written before its children are, as these move the array.
void MeshTree::build(const MeshSurface& surface, int node, std::vector<Vector3>& centres, int first,
                     int last) {
  Node built{};
  bound(surface, built, first, last);
  if (last - first <= kMaxLeafParts) {
    built.first = first, built.count = last - first;
    nodes_[node] = built;
    return;
  }
  Eigen::AlignedBox3d box;
  for (int i = first; i < last; ++i) box.extend(centres[parts_[i]]);
  int axis = 0;
  box.sizes().maxCoeff(&axis);
  const int middle = (first + last) / 2;
  const auto before = [&](int a, int b) {
    const double x = centres[a][axis], y = centres[b][axis];
    return x != y ? x < y : a < b;
  };
  std::nth_element(parts_.begin() + first, parts_.begin() + middle, parts_.begin() + last, before);
  built.first = static_cast<int>(nodes_.size());
  nodes_[node] = built;
  nodes_.resize(nodes_.size() + 2);
  build(surface, built.first, centres, first, middle);
  build(surface, built.first + 1, centres, middle, last);
}

/// The cone's axis is the mean of the normals, its spread their greatest angle from it: not the smallest
/// cone, but one that holds all of them. Normals that cancel have no cone that is of use: about z it comes
/// out wide.
void MeshTree::bound(const MeshSurface& surface, Node& node, int first, int last) const {
  const auto each = [&](const auto& place, const auto& normal) {
    for (int i = first; i < last; ++i) span(surface, parts_[i], place, normal);
  };
  Eigen::AlignedBox3d box;
  Vector3 sum = Vector3::Zero();
  each([&](const Vector3& p) { box.extend(p); }, [&](const Vector3& n) { sum += n; });
  node.centre = box.center(), node.half = 0.5 * box.sizes();
  node.normal = sum.norm() > 1e-9 ? Vector3(sum.normalized()) : Vector3::UnitZ();
  node.cos_spread = 1.0;
  each(
      [&](const Vector3& p) {
        const Vector3 offset = p - node.centre;
        const double up = node.normal.dot(offset);
        node.radius = std::max(node.radius, offset.norm());
        node.top = std::max(node.top, up), node.bottom = std::max(node.bottom, -up);
      },
      [&](const Vector3& n) { node.cos_spread = std::min(node.cos_spread, n.dot(node.normal)); });
  node.sin_spread = std::sqrt(std::max(0.0, 1.0 - node.cos_spread * node.cos_spread));
}

}  // namespace mrhi
