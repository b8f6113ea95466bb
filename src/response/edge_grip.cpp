#include "finger_limits.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mrhi {
namespace {

/// The pad that laps over a face bears at most this multiple of what it bears when pushed along the normal:
/// where hardly anything laps over, that face adds hardly anything.
constexpr double kMostOnAFace = 2.5;
/// More than any edge gives with these: tangential force over the push.
constexpr double kMostFriction = 4.0;

/// The faces that meet at an edge or corner, as their normals: at right angles to each other.
struct MeetingFaces {
  std::array<Vector3, 3> normals;
  std::size_t count = 0;

  void add(const Vector3& normal) { normals[count++] = normal; }

  /// Whether friction on these faces can bear the force `normal` + `drag`, which the object gives the finger:
  /// what points out of the faces presses, and all else is friction.
  bool bear(const Vector3& normal, const Vector3& drag, double friction) const {
    const Vector3 force = normal + drag;
    Vector3 rest = force;
    double push = 0.0;
    for (std::size_t i = 0; i < count; ++i) {
      const double out = std::max(0.0, normals[i].dot(force));
      if (out > kMostOnAFace * normals[i].dot(normal)) return false;
      rest -= out * normals[i];
      push += out;
    }
    return rest.squaredNorm() <= friction * friction * push * push;
  }
};

MeetingFaces faces_at(const Shape& shape, const Vector3& normal) {
  constexpr double kSameNormal = 1e-6;
  MeetingFaces faces;
  const auto add = [&](const Vector3& along) {
    const double part = along.dot(normal);
    if (std::abs(part) > kSameNormal) faces.add(part < 0.0 ? Vector3(-along) : along);
  };
  if (std::holds_alternative<Box>(shape)) {
    for (int i = 0; i < 3; ++i) add(Vector3::Unit(i));
  } else {
    add(Vector3::UnitZ());
    add(Vector3(normal.x(), normal.y(), 0.0).normalized());
  }
  return faces;
}

}  // namespace

double friction_at_edge(const Shape& shape, const Vector3& normal, const Vector3& along, double friction) {
  const MeetingFaces faces = faces_at(shape, normal);
  double lowest = friction, highest = std::max(friction, kMostFriction);
  if (faces.bear(normal, highest * along, friction)) return highest;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (lowest + highest);
    (faces.bear(normal, middle * along, friction) ? lowest : highest) = middle;
  }
  return lowest;
}

void grip_edges(ContactStep& step) {
  for (Contact& contact : step.contacts) {
    if (!contact.at_edge || !contact.touching()) continue;
    const Body& body = step.scene.bodies[contact.key.body];
    const Vector3 reach = contact.hand_point - contact.point + contact.lever;
    const Vector3 stretch = reach - contact.normal.dot(reach) * contact.normal;
    const double length = stretch.norm();
    if (length == 0.0 || body.material.dynamic_friction <= 0.0) continue;
    const PlacedShape& placed = body.shapes[contact.key.shape];
    const Quaternion to_shape =
        (step.bodies[contact.key.body].pose.orientation * placed.pose.orientation).conjugate();
    const Vector3 normal = to_shape * contact.normal, along = to_shape * (stretch / -length);
    const double friction = contact.friction == Friction::sticking ? body.material.static_friction
                                                                   : body.material.dynamic_friction;
    contact.grip = friction_at_edge(placed.shape, normal, along, friction) / friction;
  }
}

}  // namespace mrhi
