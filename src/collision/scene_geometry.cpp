#include "scene_geometry.h"

#include <limits>
#include <type_traits>

#include "flat_part.h"

namespace mrhi {
namespace {

/// Calls `of_mesh` for a mesh, `of_other` for any other shape, which answers by itself.
template <typename OfMesh, typename OfOther>
auto ask(const Shape& shape, const OfMesh& of_mesh, const OfOther& of_other) {
  return std::visit(
      [&](const auto& typed) {
        if constexpr (std::is_same_v<std::decay_t<decltype(typed)>, Mesh>) {
          return of_mesh();
        } else {
          return of_other(typed);
        }
      },
      shape);
}

}  // namespace

ClosestFeatures closest_on(const Shape& shape, const MeshCollider* mesh, const Capsule& capsule,
                           double margin) {
  constexpr double kNowhere = std::numeric_limits<double>::infinity();
  const ClosestFeatures none{kNowhere, Vector3::UnitZ(), Vector3::Zero(), 0.0};
  return ask(
      shape, [&] { return mesh->closest(capsule, margin).value_or(none); },
      [&](const auto& typed) { return typed.closest(capsule, margin); });
}

AxisSpan contact_span(const Capsule& capsule, const Shape& shape, const ClosestFeatures& features) {
  return ask(
      shape, [&] { return at_point(features); },
      [&](const auto& typed) { return typed.span(capsule, features); });
}

/// For a box, the faces whose normals are on the side of n; for a cylinder, the end and the side at n's
/// azimuth. A face parallel to n carries none of the normal force and is left out.
MeetingFaces meeting_faces(const Shape& shape, const Vector3& normal) {
  MeetingFaces faces;
  const auto add = [&](const Vector3& along) {
    const double part = along.dot(normal);
    if (std::abs(part) > kSameNormal) faces.add(part < 0.0 ? Vector3(-along) : along);
  };
  if (std::holds_alternative<Box>(shape)) {
    for (int i = 0; i < 3; ++i) add(Vector3::Unit(i));
  } else if (std::holds_alternative<Cylinder>(shape)) {
    add(Vector3::UnitZ());
    add(Vector3(normal.x(), normal.y(), 0.0).normalized());
  }
  return faces;
}

/// A phalanx that hangs over an edge is nearest to it as soon as it tilts. Its pad still touches the fraction
/// 1 - rise / depth of the length over the face beside the edge, where the axis rises by `rise` above the
/// face. The load then moves by the lever rule, as between two points over one face: it is in the middle
/// without tilt, and at the edge when the far end lifts off. Faces up to kMaxTilt from the normal count.
AxisSpan PlacedCollider::pad(const Capsule& capsule, const ClosestFeatures& features) const {
  AxisSpan pad = span(capsule, features);
  const Vector3 along = capsule.end - capsule.start;
  if (features.distance >= 0.0 || pad.s0 < pad.s1 || along.isZero(0.0)) return pad;
  if (mesh_ != nullptr) return mesh_->pad(capsule, features);
  const double s = features.axis_parameter;
  const MeetingFaces faces = meeting_faces(shape_, features.normal);
  for (std::size_t i = 0; faces.count > 1 && i < faces.count; ++i) {
    const Vector3& normal = faces.normals[i];
    const double tilt = normal.cross(features.normal).norm();
    if (tilt > kMaxTilt) continue;
    const auto touching = [&](double until) {
      const double rise = std::abs(normal.dot(along) * (until - s));
      const double lifted = std::max(rise / -features.distance, tilt / kMaxTilt);
      return s + std::max(0.0, 1.0 - lifted) * (until - s);
    };
    const AxisSpan face = contact_span(capsule, shape_, {features.distance, normal, features.point, s});
    pad.s0 = std::min(pad.s0, touching(face.s0)), pad.s1 = std::max(pad.s1, touching(face.s1));
  }
  return pad;
}

PlacedCollider::PlacedCollider(const PlacedShape& placed, const MeshCollider* mesh)
    : shape_(placed.shape),
      mesh_(mesh),
      has_bodys_frame_(placed.pose.position.isZero(0.0) && placed.pose.orientation.vec().isZero(0.0)),
      rotation_(placed.pose.orientation.toRotationMatrix()),
      position_(placed.pose.position) {}

SceneGeometry::SceneGeometry(const Scene& scene)
    : meshes(scene.bodies.size()), shapes(scene.bodies.size()), colliders(scene.bodies.size()) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    for (const PlacedShape& placed : scene.bodies[b].shapes) {
      const Mesh* mesh = std::get_if<Mesh>(&placed.shape);
      meshes[b].push_back(mesh != nullptr ? shared_collider(mesh->triangles) : nullptr);
      shapes[b].emplace_back(placed.shape, meshes[b].back().get());
      colliders[b].emplace_back(placed, meshes[b].back().get());
    }
  }
}

}  // namespace mrhi
