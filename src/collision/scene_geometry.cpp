#include "scene_geometry.h"

#include "flat_part.h"

namespace mrhi {

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
  if (mesh != nullptr) return mesh->pad(capsule, features);
  const double s = features.axis_parameter;
  const MeetingFaces faces = meeting_faces(shape, features.normal);
  for (std::size_t i = 0; faces.count > 1 && i < faces.count; ++i) {
    const Vector3& normal = faces.normals[i];
    const double tilt = normal.cross(features.normal).norm();
    if (tilt > kMaxTilt) continue;
    const auto touching = [&](double until) {
      const double rise = std::abs(normal.dot(along) * (until - s));
      const double lifted = std::max(rise / -features.distance, tilt / kMaxTilt);
      return s + std::max(0.0, 1.0 - lifted) * (until - s);
    };
    const AxisSpan face = contact_span(capsule, shape, {features.distance, normal, features.point, s});
    pad.s0 = std::min(pad.s0, touching(face.s0)), pad.s1 = std::max(pad.s1, touching(face.s1));
  }
  return pad;
}

PlacedCollider::PlacedCollider(const PlacedShape& placed, const MeshCollider* collider)
    : ManifoldShape(placed.shape, collider),
      pose(placed.pose),
      has_bodys_frame_(pose.position.isZero(0.0) && pose.orientation.vec().isZero(0.0)),
      rotation_(pose.orientation.toRotationMatrix()) {}

SceneGeometry::SceneGeometry(const Scene& scene) : colliders(scene.bodies.size()) {
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    for (const PlacedShape& placed : scene.bodies[b].shapes) {
      const Mesh* mesh = std::get_if<Mesh>(&placed.shape);
      if (mesh != nullptr) meshes.push_back(shared_collider(mesh->triangles));
      colliders[b].emplace_back(placed, mesh != nullptr ? meshes.back().get() : nullptr);
    }
  }
}

}  // namespace mrhi
