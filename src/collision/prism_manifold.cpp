#include "body_manifold.h"

#include <algorithm>
#include <array>

#include "flat_face.h"
#include "prism.h"
#include "scene_geometry.h"

namespace mrhi {
namespace {

/// Largest component along an edge or side of a direction that it faces.
constexpr double kFaces = 1e-6, kAlmostFaces = 0.01;
constexpr double kAnyDistance = 1e300;
/// Names of two points at which lines touch.
constexpr int kSides = 200;

double deepest_depth(const Manifold& manifold) {
  return manifold.count > 0 ? manifold.deepest().depth : -1e300;
}

/// What touches by a face, if the direction n (out of b towards a, best of those tried) is near the normal of
/// one: the larger face's normal, if both have it.
struct FlatContact {
  FlatContact(const Prism& a, const Prism& b, const Vector3& n, double separation, double margin)
      : of_a(face_towards(a, -n)), of_b(face_towards(b, n)) {
    const bool a_flat = -of_a.normal.dot(n) >= kSameFace, b_flat = of_b.normal.dot(n) >= kSameFace;
    exists = a_flat || b_flat;
    if (!exists) return;
    by_a = a_flat && (!b_flat || first_is_reference(of_a.area(), of_b.area(), n));
    // Faces that are both near n face each other.
    if (by_a) {
      manifold = touch(of_a, b_flat ? of_b : lying_towards(b, -of_a.normal), true, margin);
    } else {
      manifold = touch(of_b, a_flat ? of_a : lying_towards(a, -of_b.normal), false, margin);
    }
    found = as_deep(deepest_depth(manifold), separation);
  }

  /// Is no other direction better than the face's? Turned by t towards where the deepest point is w from the
  /// face's border, the overlap d grows to d cos t + w sin t at least: there the other shape still stands
  /// over the face. Turned far enough to leave by another side it is the thickness that has to be passed.
  /// That is no less than d while w >= d tan(t / 2), as (1 - cos t) / sin t = tan(t / 2). With w = 2 d it
  /// holds up to t = 127 degrees, 2 atan 2. Beyond that the way out leads through the thickness, which is
  /// more than 4 d.
  bool is_certain(double thickness) const {
    if (!found) return false;
    const double depth = deepest_depth(manifold);
    const double border = (by_a ? of_a : of_b).to_border(manifold.deepest().point);
    if (4.0 * depth >= thickness) return false;
    return depth <= 0.0 || border >= 2.0 * depth || is_wide(depth);
  }

  FlatFace of_a, of_b;
  Manifold manifold;
  bool exists = false, by_a = false;
  bool found = false;  ///< as deep as the direction says

 private:
  /// It touches as deep everywhere, in a region that is twice that wide in every direction. Over each line
  /// through two of its points the region's breadth, as |edge x normal| scales it: a convex polygon is
  /// narrowest across one of its sides (Houle & Toussaint 1988), which are among these lines.
  bool is_wide(double depth) const {
    constexpr double kSameDepth = 1e-6;
    double width = manifold.count > 2 ? 1e300 : 0.0;
    for (const ManifoldPoint& from : manifold) {
      if (from.depth < depth - kSameDepth) return false;
      for (const ManifoldPoint* to = manifold.begin(); to != &from; ++to) {
        const Vector3 edge = to->point - from.point;
        const Vector3 out = edge.cross(manifold.normal);
        double low = 0.0, high = 0.0;
        for (const ManifoldPoint& other : manifold) {
          const double beside = out.dot(other.point - from.point);
          low = std::min(low, beside), high = std::max(high, beside);
        }
        width = std::min(width, (high - low) / std::max(out.norm(), kParallel));
      }
    }
    return width >= 2.0 * depth;
  }
};

int name_of(const Line& on_a, const Line& on_b) {
  if (on_a.name >= kEdges) return corner_name(on_a.name - kEdges, true);
  if (on_b.name >= kEdges) return corner_name(on_b.name - kEdges, false);
  return crossing_name(on_a.name, on_b.name);
}

/// Where no face touches: lines that face each other, or a point. The wider tolerance first: sides that are
/// parallel to within 0.01 count as lines that lie on each other. Depth is that of the direction,
/// -separation, at the deepest point: between lines that are not quite square to n it would come out less.
Manifold lines_or_point(const Prism& a, const Prism& b, const Vector3& normal, double separation) {
  Manifold manifold;
  for (const double tolerance : {kAlmostFaces, kFaces}) {
    const Line on_a = line_facing(a, -normal, tolerance, a.axis());
    const Line on_b = line_facing(b, normal, tolerance, a.axis());
    manifold = line_on_line(on_a, on_b, normal, kSides);
    if (manifold.count == 2) break;
    manifold.points[0].feature = static_cast<std::uint8_t>(name_of(on_a, on_b));
  }
  const double missing = -separation - deepest_depth(manifold);
  for (ManifoldPoint& point : manifold) point.depth += missing;
  return manifold;
}

/// Of two convex shapes the best direction is the normal of a face of a - b, or where s is smooth a maximum
/// of it. Of prisms that is the normal of a flat face (try_flats), a direction across a straight line of each
/// (which is all for two on rectangles: Gottschalk, Lin & Manocha 1996), across one line and a side or a rim,
/// or rim on rim, which has no closed form: it is climbed from several starts. Faces come first and must be
/// beaten by kBetter, so that a face's normal stays as long as it is as good.
class Search {
 public:
  Search(const ManifoldShape& shape_a, const Prism& a, const Prism& b, double margin)
      : shape_a_(shape_a), a_(a), b_(b), margin_(margin), axis_(a, b) {
    axis_.try_flats();
  }

  double separation() const { return axis_.separation(); }
  /// Overlap across the best flat's normal.
  double breadth() const { return -axis_.separation_across(); }
  const Vector3& normal() const { return axis_.normal(); }
  bool is_beyond() const { return separation() > margin_; }

  /// The directions in turn: across a straight line of each (e_i x e_j), from an axis straight to the other's
  /// middle (a side's normal), those of distances to b's edges, and what is only found by iteration.
  void try_rest() {
    for (int i = a_.first_flat(); i < 3 && !is_beyond(); ++i)
      for (int j = b_.first_flat(); j < 3; ++j) axis_.try_direction(a_.axes.col(i).cross(b_.axes.col(j)));
    for (const Prism* prism : {&a_, &b_})
      if (prism->round) axis_.try_direction(prism->across(axis_.offset()));
    if (is_beyond()) return;
    if (!b_.round && (a_.round || separation() > 0.0)) try_gaps();
    if (!a_.round || (!b_.round && separation() > 0.0)) return;
    for (const Prism* prism : {&a_, &b_})
      for (int i = prism->first_flat(); i < 3 && !is_beyond(); ++i) axis_.try_around(prism->axes.col(i));
    if (b_.round) climb();
  }

 private:
  /// Across a gap the best direction is that of the distance: where it is none of the above, an edge or a
  /// corner of b has b's nearest place.
  void try_gaps() {
    const Quaternion turn_a(a_.axes);
    const Pose pose_a{a_.centre, turn_a};
    std::array<Vector3, 8> corners;
    for (int i = 0; i < 8; ++i) corners[static_cast<std::size_t>(i)] = pose_a.to_local(b_.corner(i));
    for (int i = 0; i < kEdges && !is_beyond(); ++i) {
      const auto [low, high] = edge_ends(i);
      const Capsule edge{corners[static_cast<std::size_t>(low)], corners[static_cast<std::size_t>(high)],
                         0.0};
      const ClosestFeatures features = closest_on(shape_a_.shape, shape_a_.mesh, edge, kAnyDistance);
      if (features.distance > 0.0) axis_.try_direction(turn_a * features.normal);
    }
  }
  /// Starts: the line of centres, aslant from either axis towards the other (where a rim is), and either of
  /// these mixed into the best so far: s has several tops once the shapes overlap.
  void climb() {
    const auto aslant = [&](const Prism& prism) -> Vector3 {
      const Vector3 out = prism.across(axis_.offset());
      return (prism.axis().dot(axis_.offset()) < 0.0 ? -1.0 : 1.0) * prism.axis() +
             out / std::max(out.norm(), kParallel);
    };
    for (const Vector3& start : {axis_.offset(), aslant(a_), aslant(b_), Vector3(normal() + 0.2 * aslant(a_)),
                                 Vector3(normal() + 0.2 * aslant(b_))})
      axis_.climb(start);
  }

  const ManifoldShape& shape_a_;
  const Prism &a_, &b_;
  const double margin_;
  ConvexAxis axis_;
};

}  // namespace

/// Faces first: what stands or lies on one needs no more. The thickness is the lesser extent of the two along
/// the face's normal: 2 h(n).
Manifold prism_manifold(const ManifoldShape& shape_a, const Pose& pose_a, const ManifoldShape& shape_b,
                        const Pose& pose_b, double margin, double least_breadth) {
  const Prism a(*shape_a.prism, pose_a), b(*shape_b.prism, pose_b);
  Search search(shape_a, a, b, margin);
  if (search.is_beyond()) return {};
  const double breadth = search.breadth();
  if (breadth < least_breadth && -search.separation() < least_breadth) return {};
  const Vector3 face_normal = search.normal();
  FlatContact flat(a, b, face_normal, search.separation(), margin);
  if (flat.is_certain(2.0 * std::min(a.reach(face_normal), b.reach(face_normal)))) {
    flat.manifold.breadth = breadth;
    return flat.manifold;
  }
  search.try_rest();
  if (search.is_beyond()) return {};
  if (search.normal() != face_normal) flat = {a, b, search.normal(), search.separation(), margin};
  flat.manifold.breadth = breadth;
  return flat.found ? flat.manifold : lines_or_point(a, b, search.normal(), search.separation());
}

}  // namespace mrhi
