#include "pair_manifolds.h"

#include <algorithm>

#include "closest_features.h"
#include "convex_axis.h"
#include "flat_face.h"

namespace mrhi {
namespace {

/// An edge or a side faces a direction that is across it by this.
constexpr double kFaces = 1e-6, kAlmostFaces = 0.01;
/// Names of what touches with neither cap nor face.
constexpr int kEdgeOrCorner = 160, kSides = 200;
/// A place within this part of an edge's length from its end is the end.
constexpr double kAtEnd = 1e-9;

const ManifoldPoint* deepest_of(const Manifold& manifold) {
  const auto shallower = [](const ManifoldPoint& a, const ManifoldPoint& b) { return a.depth < b.depth; };
  return std::max_element(manifold.points.begin(), manifold.points.begin() + manifold.count, shallower);
}
double deepest_depth(const Manifold& manifold) {
  return manifold.count > 0 ? deepest_of(manifold)->depth : -1e300;
}

/// What touches by a face, if the direction n (out of b towards a, best of those tried) is near the normal of
/// one: the larger face's normal, if both have it.
template <typename ShapeA, typename ShapeB>
struct FlatContact {
  FlatContact(const ShapeA& a, const ShapeB& b, const Vector3& n, double separation, double margin)
      : of_a(face_towards(a, -n)), of_b(face_towards(b, n)) {
    const bool a_flat = -of_a.normal.dot(n) >= kSameFace, b_flat = of_b.normal.dot(n) >= kSameFace;
    exists = a_flat || b_flat;
    if (!exists) return;
    by_a = a_flat && (!b_flat || first_is_reference(of_a.area(), of_b.area(), n));
    manifold = by_a ? touch(of_a, lying_towards(b, -of_a.normal), true, margin)
                    : touch(of_b, lying_towards(a, -of_b.normal), false, margin);
    found = as_deep(deepest_depth(manifold), separation);
  }

  /// Is no other direction better than the face's? Turned by t towards where the deepest point is w from the
  /// face's border, the overlap d grows to d cos t + w sin t at least: there the other shape still stands
  /// over the face. Turned far enough to leave by another side it is the thickness that has to be passed.
  bool is_certain(double thickness) const {
    if (!found) return false;
    const double depth = deepest_depth(manifold);
    const double border = (by_a ? of_a : of_b).to_border(deepest_of(manifold)->point);
    if (4.0 * depth >= thickness) return false;
    return depth <= 0.0 || border >= 2.0 * depth || is_wide(depth);
  }

  FlatFace of_a, of_b;
  Manifold manifold;
  bool exists = false, by_a = false;
  bool found = false;  ///< as deep as the direction says

 private:
  /// It touches as deep everywhere, in a region that is twice that wide in every direction.
  bool is_wide(double depth) const {
    constexpr double kSameDepth = 1e-6;
    double width = manifold.count > 2 ? 1e300 : 0.0;
    for (int i = 0; i < manifold.count; ++i) {
      const ManifoldPoint& from = manifold.points[static_cast<std::size_t>(i)];
      if (from.depth < depth - kSameDepth) return false;
      for (int j = 0; j < i; ++j) {
        const Vector3 edge = manifold.points[static_cast<std::size_t>(j)].point - from.point;
        const Vector3 out = edge.cross(manifold.normal);
        double low = 0.0, high = 0.0;
        for (int k = 0; k < manifold.count; ++k) {
          const double beside = out.dot(manifold.points[static_cast<std::size_t>(k)].point - from.point);
          low = std::min(low, beside), high = std::max(high, beside);
        }
        width = std::min(width, (high - low) / std::max(out.norm(), kParallel));
      }
    }
    return width >= 2.0 * depth;
  }
};

int name_facing(const OrientedCylinder&, const Line&) {
  return kEdgeOrCorner;
}
int name_facing(const OrientedBox& box, const Line& line) {
  const Vector3 local = box.axes.transpose() * (line.middle - box.centre);
  int corner = 0, edge = -1;
  for (int i = 0; i < 3; ++i) {
    corner |= int(local[i] >= 0.0) << i;
    if (line.half > 0.0 && box.axes.col(i).dot(line.along) > 0.9) edge = i;
  }
  return kEdgeOrCorner + (edge < 0 ? kBoxEdges + corner : edge_name(edge, corner));
}

/// Where a round side or a rim touches, and no face does.
template <typename ShapeB>
Manifold lines_or_point(const OrientedCylinder& a, const ShapeB& b, const Vector3& normal,
                        double separation) {
  for (const double tolerance : {kAlmostFaces, kFaces}) {
    const Line on_a = line_facing(a, -normal, tolerance, a.axis);
    const Line on_b = line_facing(b, normal, tolerance, a.axis);
    const bool both = on_a.half > 0.0 && on_b.half > 0.0;
    if (tolerance == kAlmostFaces && !both) continue;
    Manifold manifold = line_on_line(on_a, on_b, normal, kSides);
    if (manifold.count == 2) {
      const double missing = -separation - deepest_depth(manifold);
      manifold.points[0].depth += missing, manifold.points[1].depth += missing;
      return manifold;
    }
    if (tolerance == kAlmostFaces) continue;
    manifold.points[0].depth = -separation;
    manifold.points[0].feature = static_cast<std::uint8_t>(name_facing(b, on_b));
    return manifold;
  }
  return {};
}

using CylinderBoxAxis = ConvexAxis<OrientedCylinder, OrientedBox>;
using CylindersAxis = ConvexAxis<OrientedCylinder, OrientedCylinder>;

/// Where the cylinder is beside a corner of the box, or its rim over one.
void try_corners(const OrientedCylinder& a, const OrientedBox& b, CylinderBoxAxis& axis) {
  Vector3 least = Vector3::Zero();
  double nearest = 1e300;
  for (int bits = 0; bits < kBoxCorners; ++bits) {
    const Vector3 corner = b.corner(bits) - a.centre;
    const Vector3 level = a.across(corner);
    const double squared = level.squaredNorm();
    if (squared < nearest) nearest = squared, least = level;
    const double height = a.axis.dot(corner), above = std::abs(height) - a.half_length;
    if (above <= 0.0 || squared <= a.radius * a.radius) continue;
    const double beside = 1.0 - a.radius / std::sqrt(squared);
    axis.try_direction(beside * level + (height < 0.0 ? -above : above) * a.axis);
  }
  axis.try_direction(least);
}

void try_flats(const OrientedCylinder& a, const OrientedBox& b, CylinderBoxAxis& axis) {
  for (int i = 0; i < 3; ++i) axis.try_direction(b.axes.col(i));
  axis.try_direction(a.axis);
}
void try_flats(const OrientedCylinder& a, const OrientedCylinder& b, CylindersAxis& axis) {
  axis.try_direction(a.axis);
  axis.try_direction(b.axis);
}

/// Of two convex shapes the best direction is the normal of a face of a - b, or where s is smooth a maximum
/// of it. Of a cylinder and a box: faces and caps (try_flats), a side line across an edge, a side or a rim at
/// a corner, a rim on an edge (across the edge). Of two cylinders: a side line across the other, a side on a
/// rim (across the one's axis), and rim on rim, which has no closed form: it is climbed from several starts.
void try_rest(const OrientedCylinder& a, const OrientedBox& b, double margin, CylinderBoxAxis& axis) {
  for (int i = 0; i < 3; ++i) axis.try_direction(b.axes.col(i).cross(a.axis));
  try_corners(a, b, axis);
  for (int i = 0; i < 3 && axis.separation() <= margin; ++i) axis.try_around(b.axes.col(i));
}
void try_rest(const OrientedCylinder& a, const OrientedCylinder& b, double margin, CylindersAxis& axis) {
  axis.try_direction(a.axis.cross(b.axis));
  axis.try_direction(a.across(axis.offset()));
  axis.try_direction(b.across(axis.offset()));
  if (axis.separation() > margin) return;
  axis.try_around(a.axis);
  axis.try_around(b.axis);
  const auto aslant = [&](const OrientedCylinder& c) -> Vector3 {
    const Vector3 out = c.across(axis.offset());
    return (c.axis.dot(axis.offset()) < 0.0 ? -1.0 : 1.0) * c.axis + out / std::max(out.norm(), kParallel);
  };
  for (const Vector3& start : {axis.offset(), aslant(a), aslant(b), Vector3(axis.normal() + 0.2 * aslant(a)),
                               Vector3(axis.normal() + 0.2 * aslant(b))}) {
    axis.climb(start);
  }
}

/// Faces first: what stands or lies on one needs no more.
template <typename ShapeB>
Manifold cylinder_manifold(const OrientedCylinder& a, const ShapeB& b, double margin) {
  ConvexAxis<OrientedCylinder, ShapeB> axis(a, b);
  try_flats(a, b, axis);
  if (axis.separation() > margin) return {};
  const Vector3 face_normal = axis.normal();
  FlatContact flat(a, b, face_normal, axis.separation(), margin);
  if (flat.is_certain(2.0 * std::min(a.reach(face_normal), b.reach(face_normal)))) return flat.manifold;
  try_rest(a, b, margin, axis);
  if (axis.separation() > margin) return {};
  if (axis.normal() != face_normal) flat = {a, b, axis.normal(), axis.separation(), margin};
  return flat.found ? flat.manifold : lines_or_point(a, b, axis.normal(), axis.separation());
}

/// Two boxes by the separating axis theorem: the faces' normals and the crosses of two edges are the normals
/// of the faces of a - b, so that the best of these 15 is the least overlap (Gottschalk, Lin & Manocha 1996).
/// Across a gap it is the distance where a face or two crossing edges are nearest.
class BoxPair {
 public:
  BoxPair(const OrientedBox& a, const OrientedBox& b)
      : a_(a),
        b_(b),
        offset_(a.centre - b.centre),
        in_a_(a.axes.transpose() * offset_),
        in_b_(b.axes.transpose() * offset_),
        turn_(a.axes.transpose() * b.axes),
        abs_turn_(turn_.cwiseAbs()) {}

  Manifold manifold(double margin) {
    try_faces();
    if (separation_ > margin) return {};
    try_edges();
    if (separation_ > margin) return {};
    const FlatContact flat(a_, b_, normal_, separation_, margin);
    if (flat.found || (flat.exists && separation_ <= 0.0)) return flat.manifold;
    Manifold crossed;
    if (!flat.exists && cross(crossed)) return crossed;
    return nearest(margin);
  }

 private:
  /// An edge-edge axis has to be this much better than a face's: edges that are nearly parallel have a face's
  /// normal for theirs, but touch at a point [m].
  static constexpr double kEdgeBias = 1e-6;
  /// Edges whose sine squared is less are parallel: a face's normal is as good.
  static constexpr double kParallelEdges = 1e-10;

  void try_faces() {
    const Vector3 reach_a = a_.half + abs_turn_ * b_.half;
    const Vector3 reach_b = b_.half + abs_turn_.transpose() * a_.half;
    for (int i = 0; i < 3; ++i) {
      try_axis(std::abs(in_a_[i]) - reach_a[i], in_a_[i] < 0.0, a_.axes.col(i));
      try_axis(std::abs(in_b_[i]) - reach_b[i], in_b_[i] < 0.0, b_.axes.col(i));
    }
  }
  void try_axis(double separation, bool flip, const Vector3& axis) {
    if (separation <= separation_) return;
    separation_ = separation;
    normal_ = flip ? Vector3(-axis) : axis;
  }
  void try_edges() {
    double best = -1e300;
    int i_best = 0, j_best = 0;
    for (int i = 0; i < 3; ++i) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
      for (int j = 0; j < 3; ++j) {
        const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        const double squared = turn_(i1, j) * turn_(i1, j) + turn_(i2, j) * turn_(i2, j);
        if (squared < kParallelEdges) continue;
        const double along = in_a_[i2] * turn_(i1, j) - in_a_[i1] * turn_(i2, j);
        const double reach = a_.half[i1] * abs_turn_(i2, j) + a_.half[i2] * abs_turn_(i1, j) +
                             b_.half[j1] * abs_turn_(i, j2) + b_.half[j2] * abs_turn_(i, j1);
        const double separation = (std::abs(along) - reach) / std::sqrt(squared);
        if (separation > best) best = separation, i_best = i, j_best = j;
      }
    }
    if (best <= separation_ + kEdgeBias) return;
    separation_ = best, edge_of_a_ = i_best, edge_of_b_ = j_best;
    normal_ = a_.axes.col(edge_of_a_).cross(b_.axes.col(edge_of_b_)).normalized();
    if (normal_.dot(offset_) < 0.0) normal_ = -normal_;
  }

  /// Of the edges of the best axis; false where they pass each other by.
  bool cross(Manifold& manifold) const {
    const Line on_a = line_facing(a_, -normal_, kFaces, a_.axes.col(edge_of_a_));
    const Line on_b = line_facing(b_, normal_, kFaces, b_.axes.col(edge_of_b_));
    const int name_a = name_facing(a_, on_a) - kEdgeOrCorner, name_b = name_facing(b_, on_b) - kEdgeOrCorner;
    manifold = line_on_line(on_a, on_b, normal_, crossing_name(name_a, name_b));
    const Vector3 offset = manifold.points[0].point - on_a.middle;
    const double beside = 2.0 * (offset - on_a.along.dot(offset) * on_a.along).norm();
    return separation_ <= 0.0 || as_deep(-beside, separation_);
  }

  /// Boxes that a corner or an edge keeps apart, side by side: no axis of the theorem is their distance. One
  /// of a's edges has the nearest place of a.
  Manifold nearest(double margin) const {
    ClosestFeatures best{1e300, normal_, Vector3::Zero(), 0.0};
    const Pose pose_b{b_.centre, Quaternion(b_.axes)};
    int feature = 0;
    for (int edge = 0; edge < kBoxEdges; ++edge) {
      const auto [low, high] = edge_ends(edge);
      const Capsule line{pose_b.to_local(a_.corner(low)), pose_b.to_local(a_.corner(high)), 0.0};
      const ClosestFeatures features = capsule_box(line, Box{b_.half});
      if (features.distance >= best.distance - 1e-12) continue;
      best = features;
      const double s = features.axis_parameter;
      feature = s < kAtEnd ? low : s > 1.0 - kAtEnd ? high : name_on_b(features.point, edge);
    }
    Manifold manifold;
    if (best.distance > margin) return manifold;
    manifold.normal = pose_b.orientation * best.normal;
    add_point(manifold, pose_b * Vector3(best.point + 0.5 * best.distance * best.normal), -best.distance,
              feature);
    return manifold;
  }
  /// Of the place of b's surface that an edge of a is nearest to.
  int name_on_b(const Vector3& point, int edge_of_a) const {
    int corner = 0, inside = 0, direction = 0;
    for (int i = 0; i < 3; ++i) {
      corner |= int(point[i] >= 0.0) << i;
      if (std::abs(point[i]) < (1.0 - kAtEnd) * b_.half[i]) ++inside, direction = i;
    }
    return inside == 0 ? kBoxCorners + corner : crossing_name(edge_of_a, edge_name(direction, corner));
  }

  const OrientedBox& a_;
  const OrientedBox& b_;
  Vector3 offset_, in_a_, in_b_;
  Matrix3 turn_, abs_turn_;
  double separation_ = -1e300;
  Vector3 normal_ = Vector3::UnitZ();
  int edge_of_a_ = 0, edge_of_b_ = 0;  // directions, if two edges cross
};

}  // namespace

Manifold box_box(const OrientedBox& a, const OrientedBox& b, double margin) {
  return BoxPair(a, b).manifold(margin);
}

Manifold cylinder_box(const OrientedCylinder& a, const OrientedBox& b, double margin) {
  return cylinder_manifold(a, b, margin);
}

Manifold cylinder_cylinder(const OrientedCylinder& a, const OrientedCylinder& b, double margin) {
  return cylinder_manifold(a, b, margin);
}

}  // namespace mrhi
