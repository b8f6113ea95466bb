#include "mesh_nearest.h"

namespace mrhi {

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

bool MeshNearest::is_all() const {
  return surface_.convex() && part() >= 0 && nearest().distance > kOnSurface &&
         surface_.is_support(nearest(), gap());
}

void MeshNearest::search(const MeshTree& tree, double range) {
  struct Open {
    int node;
    double squared;  // from the node's centre to the segment
  };
  const double length_squared = segment_.along.squaredNorm();
  const double per_squared = length_squared > 0.0 ? 1.0 / length_squared : 0.0;
  const auto look = [&](int node) -> Open {
    const Vector3 offset = tree.node(node).centre - segment_.start;
    const double s = std::max(0.0, std::min(per_squared * segment_.along.dot(offset), 1.0));
    return {node, (offset - s * segment_.along).squaredNorm()};
  };
  std::array<Open, MeshTree::kMostLevels> open;
  std::size_t count = 0;
  open[count++] = look(0);
  while (count > 0) {
    const Open next = open[--count];
    const MeshTree::Node& node = tree.node(next.node);
    const double limit_now = limit(range), reach = node.radius + limit_now;
    if (next.squared > reach * reach || is_below(node, limit_now)) continue;
    for (int i = node.first; i < node.first + node.count; ++i) measure(tree.part(i), range);
    if (node.count > 0) continue;
    const Open one = look(node.first), other = look(node.first + 1);
    const bool one_first = one.squared <= other.squared;
    open[count++] = one_first ? other : one;
    open[count++] = one_first ? one : other;
  }
}

/// Seen along the direction from the nearest so far to the segment, no part of the node is near enough.
bool MeshNearest::is_below(const MeshTree::Node& node, double limit) const {
  const double along = facing_.dot(node.normal);
  const double slab = along > 0.0 ? along * node.top : -along * node.bottom;
  const double below = least_ - limit - facing_.dot(node.centre) - slab;
  return below > 0.0 && below * below > (1.0 - along * along) * node.radius * node.radius;
}

/// A quick look before the part is measured.
bool MeshNearest::is_too_far(int part, double limit) const {
  if (part < faces_) {
    const MeshSurface::Face& face = surface_.faces()[static_cast<std::size_t>(part)];
    const double start = face.normal.dot(segment_.start) - face.height;
    const double end = start + face.normal.dot(segment_.along);
    return std::min(start, end) > limit || std::max(start, end) < -limit;
  }
  const MeshSurface::Edge& edge = surface_.edges()[static_cast<std::size_t>(part - faces_)];
  return least_ - facing_.dot(edge.start) - std::max(0.0, facing_.dot(edge.along)) > limit;
}

void MeshNearest::measure(int part, double range) {
  if (is_too_far(part, limit(range))) return;
  const bool is_face = part < faces_;
  const SurfaceNearest now =
      is_face ? surface_.nearest_on_face(part, segment_) : surface_.nearest_on_edge(part - faces_, segment_);
  SurfaceNearest& best = is_face ? on_face_ : on_edge_;
  int& best_part = is_face ? face_ : edge_;
  if (now.distance > best.distance || (now.distance == best.distance && part > best_part)) return;
  const bool nearer = now.distance < limit(kAnyDistance);
  best = now, best_part = part;
  if (nearer) face_nearest();
}

void MeshNearest::face_nearest() {
  const double distance = nearest().distance;
  facing_.setZero(), least_ = 0.0;
  if (distance < 1e-6) return;
  facing_ = gap() / distance;
  least_ = std::min(facing_.dot(segment_.start), facing_.dot(segment_.end()));
}

}  // namespace mrhi
