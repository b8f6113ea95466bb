#include "pair_manifolds.h"

#include <algorithm>

#include "box_face.h"
#include "mr_hand_interaction/collision/closest_features.h"

namespace mrhi {
namespace {

/// An edge-edge axis has to be this much better than a face's [m].
constexpr double kEdgeBias = 1e-6;
/// A face's deepest point may differ so much from the best axis (kSameFace, border_tolerance).
constexpr double kRelative = 1e-3, kAbsolute = 3e-6;

/// A place within this part of an edge's length from its end is the end.
constexpr double kAtEnd = 1e-9;

/// The direction, out of b towards a, along which the boxes are farthest apart or overlap least.
struct Axis {
  double separation = -1e300;
  Vector3 normal = Vector3::UnitZ();
  int edge_of_a = -1, edge_of_b = -1;  ///< directions, if two edges cross
};

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

  bool apart(double margin) {
    try_faces();
    if (axis_.separation > margin) return true;
    try_edges();
    return axis_.separation > margin;
  }

  Manifold manifold(double margin) const {
    const BoxFace face_a(a_, -axis_.normal), face_b(b_, axis_.normal);
    const bool a_flat = -face_a.normal.dot(axis_.normal) >= kSameFace;
    const bool b_flat = face_b.normal.dot(axis_.normal) >= kSameFace;
    if (!a_flat && !b_flat) return crossing(margin);
    const bool by_a = a_flat && (!b_flat || first_is_reference(face_a.area(), face_b.area(), axis_.normal));
    return by_a ? face(face_a, BoxFace(b_, -face_a.normal), true, margin)
                : face(face_b, BoxFace(a_, -face_b.normal), false, margin);
  }

 private:
  void try_faces() {
    const Vector3 reach_a = a_.half + abs_turn_ * b_.half;
    const Vector3 reach_b = b_.half + abs_turn_.transpose() * a_.half;
    for (int i = 0; i < 3; ++i) {
      try_axis(std::abs(in_a_[i]) - reach_a[i], in_a_[i] < 0.0, a_.axes.col(i));
      try_axis(std::abs(in_b_[i]) - reach_b[i], in_b_[i] < 0.0, b_.axes.col(i));
    }
  }
  void try_axis(double separation, bool flip, const Vector3& axis) {
    if (separation <= axis_.separation) return;
    axis_.separation = separation;
    axis_.normal = flip ? Vector3(-axis) : axis;
  }

  void try_edges() {
    Axis best;
    for (int i = 0; i < 3; ++i) {
      const int i1 = (i + 1) % 3, i2 = (i + 2) % 3;
      for (int j = 0; j < 3; ++j) {
        const int j1 = (j + 1) % 3, j2 = (j + 2) % 3;
        const double squared = turn_(i1, j) * turn_(i1, j) + turn_(i2, j) * turn_(i2, j);
        if (squared < 1e-10) continue;
        const double along = in_a_[i2] * turn_(i1, j) - in_a_[i1] * turn_(i2, j);
        const double reach = a_.half[i1] * abs_turn_(i2, j) + a_.half[i2] * abs_turn_(i1, j) +
                             b_.half[j1] * abs_turn_(i, j2) + b_.half[j2] * abs_turn_(i, j1);
        const double separation = (std::abs(along) - reach) / std::sqrt(squared);
        if (separation <= best.separation) continue;
        best.separation = separation, best.edge_of_a = i, best.edge_of_b = j;
      }
    }
    if (best.separation <= axis_.separation + kEdgeBias) return;
    best.normal = a_.axes.col(best.edge_of_a).cross(b_.axes.col(best.edge_of_b)).normalized();
    if (best.normal.dot(offset_) < 0.0) best.normal = -best.normal;
    axis_ = best;
  }

  Manifold face(const BoxFace& reference, const BoxFace& incident, bool by_a, double margin) const {
    ContactRegion region = clip_face(reference, incident, by_a);
    const double missing = -axis_.separation - region.deepest();
    const bool side_by_side = missing > kRelative * std::abs(axis_.separation) + kAbsolute;
    if (side_by_side && axis_.separation > 0.0) return nearest(margin);
    region.remove_gaps(margin);
    region.reduce();
    Manifold manifold;
    manifold.normal = by_a ? Vector3(-reference.normal) : reference.normal;
    for (int i = 0; i < region.count; ++i) {
      const RegionPoint& p = region[i];
      add_point(manifold,
                reference.centre + p.u * reference.along[0] + p.v * reference.along[1] -
                    0.5 * p.depth * reference.normal,
                p.depth, p.feature);
    }
    return manifold;
  }

  Manifold crossing(double margin) const {
    const int i = axis_.edge_of_a, j = axis_.edge_of_b;
    const Vector3& n = axis_.normal;
    const int corner_a = facing_corner(a_, -n), corner_b = facing_corner(b_, n);
    const Vector3 edge_a = a_.corner(corner_a | 1 << i) - a_.half[i] * a_.axes.col(i);
    const Vector3 edge_b = b_.corner(corner_b | 1 << j) - b_.half[j] * b_.axes.col(j);
    // The edges' lines, one shifted along n onto the other, meet.
    const Vector3 apart = edge_b - edge_a;
    const double cosine = turn_(i, j), s = apart.dot(a_.axes.col(i)), t = apart.dot(b_.axes.col(j));
    const double on_a = (s - cosine * t) / (1.0 - cosine * cosine);
    const double on_b = (cosine * s - t) / (1.0 - cosine * cosine);
    const bool beside = std::abs(on_a) > a_.half[i] + kAbsolute || std::abs(on_b) > b_.half[j] + kAbsolute;
    if (beside && axis_.separation > 0.0) return nearest(margin);
    Manifold manifold;
    manifold.normal = n;
    add_point(manifold, 0.5 * (edge_a + on_a * a_.axes.col(i) + edge_b + on_b * b_.axes.col(j)),
              -axis_.separation, crossing_name(edge_name(i, corner_a), edge_name(j, corner_b)));
    return manifold;
  }

  static int facing_corner(const OrientedBox& box, const Vector3& n) {
    const Vector3 local = box.axes.transpose() * n;
    return int(local[0] >= 0.0) | int(local[1] >= 0.0) << 1 | int(local[2] >= 0.0) << 2;
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
  Manifold nearest(double margin) const;

  const OrientedBox& a_;
  const OrientedBox& b_;
  Vector3 offset_, in_a_, in_b_;
  Matrix3 turn_, abs_turn_;
  Axis axis_;
};

/// Boxes that a corner or an edge keeps apart, side by side: no axis of the theorem is their distance.
Manifold BoxPair::nearest(double margin) const {
  ClosestFeatures best{1e300, axis_.normal, Vector3::Zero(), 0.0};
  const Pose pose_b{b_.centre, Quaternion(b_.axes)};
  int feature = 0;
  for (int edge = 0; edge < kBoxEdges; ++edge) {
    const int i = edge / 4;
    const int low = (edge & 1) << (i + 1) % 3 | (edge >> 1 & 1) << (i + 2) % 3;
    const Capsule line{pose_b.to_local(a_.corner(low)), pose_b.to_local(a_.corner(low | 1 << i)), 0.0};
    const ClosestFeatures features = capsule_box(line, Box{b_.half});
    if (features.distance >= best.distance - 1e-12) continue;
    best = features;
    const double s = features.axis_parameter;
    feature = s < kAtEnd ? low : s > 1.0 - kAtEnd ? low | 1 << i : name_on_b(features.point, edge);
  }
  Manifold manifold;
  if (best.distance > margin) return manifold;
  manifold.normal = pose_b.orientation * best.normal;
  add_point(manifold, pose_b * Vector3(best.point + 0.5 * best.distance * best.normal), -best.distance,
            feature);
  return manifold;
}

}  // namespace

Manifold box_box(const OrientedBox& a, const OrientedBox& b, double margin) {
  BoxPair pair(a, b);
  if (pair.apart(margin)) return {};
  return pair.manifold(margin);
}

}  // namespace mrhi
