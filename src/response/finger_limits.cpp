#include "finger_limits.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {
namespace {

/// The pad that laps over a face bears at most this multiple of what it bears when pushed along the normal:
/// where hardly anything laps over, that face adds hardly anything.
constexpr double kMostOnAFace = 2.5;
/// A shorter stretch is rounding and has no direction [m].
constexpr double kMinStretch = 1e-9;
/// More than any edge gives with these: tangential force over the push.
constexpr double kMostFriction = 4.0;

/// The faces that meet at an edge or corner, as their normals: at right angles to each other.
struct MeetingFaces {
  std::array<Vector3, 3> normals;
  std::size_t count = 0;

  void add(const Vector3& normal) { normals[count++] = normal; }

  /// Whether friction on these faces can bear the force F = normal + drag, which the object gives the finger:
  /// what points out of a face presses, N_i = max(0, n_i.F), and all else is friction, |F - sum N_i n_i| <=
  /// mu sum N_i.
  /// A cone about n alone, 30 to 45 degrees off the faces, would let the edge be squeezed out like a pip.
  /// Where N_i would be more than kMostOnAFace n_i.n, the part of a unit push along n that the face has by
  /// itself, it is not borne.
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

// Of a box the three on n's side, of a cylinder the end and the side at n's azimuth. One that n lies in has
// no part of the push and is none of them.
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

// The largest f for which the faces bear normal + f along, by halving; 20 times leave 4e-6 of the push.
// Halving takes it that they bear every f up to the largest. The least is what a face has by itself.
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

// grip = f_edge / mu (phi of a contact that slips), by which the spring's limit is multiplied. It is found
// for the way in which the contact is drawn at the step's start, and held through the step, so that the
// step's problem stays convex.
void grip_edges(ContactStep& step) {
  for (Contact& contact : step.contacts) {
    if (!contact.at_edge || !contact.touching()) continue;
    const Body& body = step.scene.bodies[contact.key.body];
    const Vector3 reach = contact.hand_point - contact.point + contact.lever;
    const Vector3 stretch = reach - contact.normal.dot(reach) * contact.normal;
    const double length = stretch.norm();
    if (length <= kMinStretch || body.material.dynamic_friction <= 0.0) continue;
    const PlacedShape& placed = body.shapes[contact.key.shape];
    const Quaternion to_shape =
        (step.bodies[contact.key.body].pose.orientation * placed.pose.orientation).conjugate();
    // The object holds the finger back against the way in which it is drawn: the trap is the sign, as
    // stretch is p - c, and friction on the object is along it.
    const Vector3 normal = to_shape * contact.normal, along = to_shape * (stretch / -length);
    const double friction = contact.friction == Friction::sticking ? body.material.static_friction
                                                                   : body.material.dynamic_friction;
    contact.grip = friction_at_edge(placed.shape, normal, along, friction) / friction;
  }
}

namespace {

constexpr int kHandParts = kFingers + 1;  // of a hand: its fingers and the palm

bool is_palm(const ContactKey& key) {
  return key.capsule == kPalm;
}
double pressed_by(const Contact& contact) {
  return contact.ignored ? 0.0 : contact.share * std::max(contact.pressed(), 0.0);
}

}  // namespace

// A finger gives way once its contacts together push with its strength: each has the part of it that it has
// of the depths, as equal springs side by side.
//
//     S_i = S d_i / sum d,     d_i = share max(0, depth - compliance)
//
// of all points of the finger on all bodies. A point that does not press has all of S, should it come to
// press within the step.
void share_strength(const HandStrength& hand, std::vector<Contact>& contacts) {
  std::array<std::array<double, kHandParts>, kMaxHands> depths{};
  const auto of = [&depths](const ContactKey& key) -> double& {
    return depths[key.hand][static_cast<std::size_t>(finger_of(key.capsule))];
  };
  for (const Contact& contact : contacts) of(contact.key) += pressed_by(contact);
  for (Contact& contact : contacts) {
    const double together = of(contact.key), strength = is_palm(contact.key) ? hand.palm : hand.finger;
    const double part = together > 0.0 ? pressed_by(contact) / together : 1.0;
    contact.strength = part > 0.0 ? part * strength : strength;
    contact.inverse_mass = 1.0 / (is_palm(contact.key) ? hand.palm_mass : hand.finger_mass);
    contact.restitution = hand.restitution;
  }
}

}  // namespace mrhi
