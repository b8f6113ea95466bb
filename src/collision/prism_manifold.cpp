#include "contact_region.h"

#include <algorithm>
#include <array>

#include "scene_geometry.h"

namespace mrhi {
namespace {

/// Cosine above which a round shape meets a face with its cap, and below which with a line of its side.
constexpr double kMinCapCosine = 0.7071067811865476;

/// Smallest angle at which crossing lines touch at a point [rad].
constexpr double kMinCrossingAngle = 0.1;
/// Largest difference of depths along a level line [m].
constexpr double kLevelLine = 1e-9;

double clamp(double x, double lo, double hi) {
  return std::max(lo, std::min(x, hi));
}

/// How far along `a` the lines, seen along the normal, are nearest. With p = apart, a and b unit and c = a.b,
/// |p + t b - s a|^2 is least where
///     s = a.p + c t   and   t (1 - c^2) = c a.p - b.p,
/// with 1 - c^2 = |a x b|^2 from the cross product, as it cancels for lines that are almost parallel. Below
/// 1e-10 rad every s is as good.
double crossing(const Line& a, const Line& b, const Vector3& apart) {
  const double cosine = a.along.dot(b.along), s = apart.dot(a.along), t = apart.dot(b.along);
  const double sine_squared = a.along.cross(b.along).squaredNorm();
  if (sine_squared < 1e-20) return clamp(s, -a.half, a.half);
  const double on_b = clamp((cosine * s - t) / sine_squared, -b.half, b.half);
  return clamp(s + cosine * on_b, -a.half, a.half);
}

}  // namespace

/// Flat along itself only: `along` has the one direction, no breadth, and its two corners are the line's
/// ends, at +half and -half.
FlatFace FlatFace::of(const Line& line) {
  return {line.middle,
          Vector3::Zero(),
          {{line.along, Vector3::Zero()}},
          {{line.half, 0.0}},
          Outline::line,
          {{0, 1, 0, 0}},
          {}};
}

double FlatFace::to_border(const Vector3& point) const {
  const Vector3 offset = point - centre;
  if (is(Outline::circle)) return half[0] - (offset - normal.dot(offset) * normal).norm();
  return std::min(half[0] - std::abs(along[0].dot(offset)), half[1] - std::abs(along[1].dot(offset)));
}

/// Largest component of `outward` in the prism's axes; a disc has its caps alone.
FlatFace face_towards(const Prism& prism, const Vector3& outward) {
  const Vector3 local = prism.axes.transpose() * outward;
  int side = 2;
  if (!prism.round) local.cwiseAbs().maxCoeff(&side);
  const int first = (side + 1) % 3, second = (side + 2) % 3;
  const bool positive = local[side] >= 0.0;
  FlatFace face;
  face.normal = (positive ? 1.0 : -1.0) * prism.axes.col(side);
  face.centre = prism.centre + prism.half[side] * face.normal;
  face.along = {{prism.axes.col(first), prism.axes.col(second)}};
  face.half = {{prism.half[first], prism.half[second]}};
  face.outline = prism.round ? FlatFace::Outline::circle : FlatFace::Outline::rectangle;
  for (std::size_t i = 0; i < 4; ++i) {
    face.corners[i] = prism.round ? 4 * int(positive) + int(i)
                                  : (int(positive) << side) | (int(kCorner[i][0] > 0) << first) |
                                        (int(kCorner[i][1] > 0) << second);
    face.edges[i] = prism.round ? 0 : edge_name(i % 2 == 0 ? first : second, face.corners[i]);
  }
  return face;
}

FlatFace lying_towards(const Prism& prism, const Vector3& outward) {
  const bool on_side = prism.round && std::abs(prism.axis().dot(outward)) < kMinCapCosine;
  return on_side ? FlatFace::of(side_line(prism, outward)) : face_towards(prism, outward);
}

/// |n.axis i| < tolerance is the sine of the angle by which axis i is off square to n. The line's middle is
/// the support point with its part along the axis taken off: of a rectangle's edge the middle, of a round
/// side's line too.
Line line_facing(const Prism& prism, const Vector3& n, double tolerance, const Vector3& beside) {
  const Vector3 local = prism.axes.transpose() * n, parallel = prism.axes.transpose() * beside;
  int direction = -1, corner = 0;
  for (int i = prism.first_flat(); i < 3; ++i) {
    if (std::abs(local[i]) >= tolerance) continue;
    if (direction < 0 || std::abs(parallel[i]) > std::abs(parallel[direction])) direction = i;
  }
  for (int i = 0; i < 3; ++i) corner |= int(local[i] >= 0.0) << i;
  const Vector3 end = prism.centre + prism.farthest(n);
  if (direction < 0) return {end, prism.axis(), 0.0, prism.round ? 0 : kEdges + corner};
  const Vector3 along = prism.axes.col(direction);
  return {end - along.dot(end - prism.centre) * along, along, prism.half[direction],
          prism.round ? 0 : edge_name(direction, corner)};
}

/// Parallel lines of half lengths h_a and h_b face each other where |s - middle| <= c h_b and |s| <= h_a, s
/// along a. Depth n.(on b - on a) is > 0 where b's line is above a's along n, which points from b to a.
/// Turned across each other by psi the two points draw together in proportion to 1 - sin psi / 0.1, about the
/// deeper end where depth changes along the lines, else about the crossing.
Manifold line_on_line(const Line& a, const Line& b, const Vector3& normal, int feature) {
  Manifold manifold;
  manifold.normal = normal;
  const Vector3 gap = b.middle - a.middle;
  const Vector3 apart = gap - gap.dot(normal) * normal;
  const auto add = [&](double s, int name) {
    const Vector3 on_a = a.at(s);
    const Vector3 beside = on_a + gap.dot(normal) * normal;
    const Vector3 on_b = b.at(clamp((beside - b.middle).dot(b.along), -b.half, b.half));
    const double depth = normal.dot(on_b - on_a);
    add_point(manifold, 0.5 * (on_a + on_b), depth, name);
  };
  const double across = a.along.cross(b.along).norm();
  const double ends = std::abs(a.along.dot(b.along)) * b.half, middle = apart.dot(a.along);
  const double from = std::max(-a.half, middle - ends), to = std::min(a.half, middle + ends);
  if (a.half == 0.0 || b.half == 0.0 || across >= kMinCrossingAngle || from >= to) {
    add(crossing(a, b, apart), feature);
    return manifold;
  }
  const double part = 1.0 - across / kMinCrossingAngle;
  const double rises =
      normal.dot(b.along * (a.along.dot(b.along) < 0.0 ? -1.0 : 1.0) - a.along) * (to - from);
  double kept = across < 1e-9 ? 0.5 * (from + to) : clamp(crossing(a, b, apart), from, to);
  if (rises > kLevelLine) kept = to;
  if (rises < -kLevelLine) kept = from;
  add(kept + part * (from - kept), feature);
  add(kept + part * (to - kept), feature + 1);
  return manifold;
}

namespace {

/// Largest component along an edge or side of a direction that it faces.
constexpr double kMaxAcross = 1e-6, kMaxAlmostAcross = 0.01;
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
  for (const double tolerance : {kMaxAlmostAcross, kMaxAcross}) {
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
/// beaten by kMinImprovement, so that a face's normal stays as long as it is as good.
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
    for (int i = 0; i < 8; ++i) corners[i] = pose_a.to_local(b_.corner(i));
    for (int i = 0; i < kEdges && !is_beyond(); ++i) {
      const auto [low, high] = edge_ends(i);
      const Capsule edge{corners[low], corners[high], 0.0};
      const auto features = shape_a_.closest(edge, kAnyDistance);
      if (features->distance > 0.0) axis_.try_direction(turn_a * features->normal);
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
