#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// Closest points of a capsule of the hand (body 1) and a shape (body 2), or of least overlap. In the frame
/// of the arguments. With a(s) the axis's point and r the capsule's radius:
///     a(s) = point + (distance + r) normal,   distance = normal.(a(s) - point) - r,
/// except for a point that was clamped to the shape's border. With the axis inside, s is the point that
/// leaves the shape last along the shortest separating translation.
struct ClosestFeatures {
  /// Signed: > 0 gap; < 0 overlap, -distance is the shortest translation that separates the two [m].
  double distance;
  Vector3 normal;         ///< unit, out of the shape towards the hand: moving the capsule along it separates
  Vector3 point;          ///< on the shape's surface
  double axis_parameter;  ///< s in 0..1 of the capsule's axis point that faces `point`
  int part = -1;          ///< of a mesh: its face, edge or corner, as MeshSurface numbers them
};

/// Closed forms; shape frame at its centre. Exact also with the capsule's axis inside. For a segment along a
/// face (to 1e-12 m) the middle of the touching interval. Of equally short directions always the same one.
ClosestFeatures capsule_sphere(const Capsule& capsule, const Sphere& sphere);
ClosestFeatures capsule_box(const Capsule& capsule, const Box& box);

/// Part s0..s1 of a capsule's axis over the flat (or straight) piece of surface at `features`, so that a
/// finger lying along a face touches with two points. s0 == s1 for a single point. Over a flat surface depth
/// is linear in s: the two ends determine it.
struct AxisSpan {
  double s0, s1;
  bool at_edge = false;  ///< of a box or a cylinder
};
AxisSpan contact_span(const Capsule& capsule, const Shape& shape, const ClosestFeatures& features);

/// Largest sine of the angle by which a pad at an edge is tilted from a face beside it and still lies on
/// that: beyond it a deep pad would lie on either face of a right angle.
constexpr double kMaxTilt = 0.7;

/// Unit normals of the perpendicular faces of a box or a cylinder that meet where its surface has a normal: a
/// single one on a face. At a cylinder's rim they are those of the cap and of the side there.
struct MeetingFaces {
  void add(const Vector3& normal) { normals[count++] = normal; }

  std::array<Vector3, 3> normals;
  std::size_t count = 0;
};
MeetingFaces meeting_faces(const Shape& shape, const Vector3& normal);

/// Distance from `point` along the unit vector `direction` to where this line leaves the shape, < 0 if that
/// lies behind the point [m]. Shape's frame. Nothing if the line misses the shape, or for a mesh.
inline std::optional<double> exit_distance(const Shape& shape, const Vector3& point,
                                           const Vector3& direction) {
  return std::visit([&](const auto& typed) { return typed.exit_distance(point, direction); }, shape);
}

}  // namespace mrhi
