#include "finger_limits.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "../collision/closest_features.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {
namespace {

/// Largest load of a face, as a multiple of its load under a force along the normal. A face on which little
/// of the pad rests adds little.
constexpr double kMaxFaceLoad = 2.5;
/// A shorter stretch is rounding and has no direction [m].
constexpr double kMinStretch = 1e-9;
/// Upper bound of friction over normal force at any edge of these parameters.
constexpr double kMaxEdgeFriction = 4.0;

/// True if friction on the faces supports the object's force on the finger, F = normal + drag. Components out
/// of a face are its normal load, N_i = max(0, n_i.F); the rest is friction, |F - sum N_i n_i| <= mu sum N_i.
///
/// A single cone about n, 30 to 45 degrees from the faces, would let the pad squeeze the edge out. A load N_i
/// above kMaxFaceLoad n_i.n, with n_i.n its part of a unit force along n, is not supported.
bool supports(const MeetingFaces& faces, const Vector3& normal, const Vector3& drag, double friction) {
  const Vector3 force = normal + drag;
  Vector3 rest = force;
  double load = 0.0;
  for (std::size_t i = 0; i < faces.count; ++i) {
    const double out = std::max(0.0, faces.normals[i].dot(force));
    if (out > kMaxFaceLoad * faces.normals[i].dot(normal)) return false;
    rest -= out * faces.normals[i];
    load += out;
  }
  return rest.squaredNorm() <= friction * friction * load * load;
}

}  // namespace

// Largest f for which the faces support normal + f along, by bisection; 20 halvings leave 4e-6 of the normal
// force. Bisection assumes that they support every f below the largest. The lower bound is the friction of a
// single face.
double friction_at_edge(const Shape& shape, const Vector3& normal, const Vector3& along, double friction) {
  const MeetingFaces faces = meeting_faces(shape, normal);
  double lowest = friction, highest = std::max(friction, kMaxEdgeFriction);
  if (supports(faces, normal, highest * along, friction)) return highest;
  for (int i = 0; i < 20; ++i) {
    const double middle = 0.5 * (lowest + highest);
    (supports(faces, normal, middle * along, friction) ? lowest : highest) = middle;
  }
  return lowest;
}

// grip = f_edge / mu (phi if the contact slips) multiplies the spring's friction limit. Its direction is that
// of the stretch at the start of the step. It is held through the step, so that the step's problem stays
// convex.
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
    // Friction on the finger opposes the stretch: stretch is p - c, and friction on the object is along it.
    const Vector3 normal = to_shape * contact.normal, along = to_shape * (stretch / -length);
    const double friction = contact.friction == Friction::sticking ? body.material.static_friction
                                                                   : body.material.dynamic_friction;
    contact.grip = friction_at_edge(placed.shape, normal, along, friction) / friction;
  }
}

namespace {

constexpr int kHandParts = kFingers + 1;  // fingers and palm

bool is_palm(const ContactKey& key) {
  return key.capsule == kPalm;
}
double shared_depth(const Contact& contact) {
  return contact.ignored ? 0.0 : contact.share * std::max(contact.pressed(), 0.0);
}

}  // namespace

// A finger complies once the sum of its contacts' normal forces reaches its strength. Each contact has a
// fraction of the strength by its depth, like equal springs in parallel:
//
//     S_i = S d_i / sum d,     d_i = share max(0, depth - compliance)
//
// The sum is over all points of the finger on all bodies. An unloaded point has the whole S, in case it is
// loaded within the step.
void share_strength(const HandStrength& hand, std::vector<Contact>& contacts) {
  std::array<std::array<double, kHandParts>, kMaxHands> depths{};
  const auto of = [&depths](const ContactKey& key) -> double& {
    return depths[key.hand][finger_of(key.capsule)];
  };
  for (const Contact& contact : contacts) of(contact.key) += shared_depth(contact);
  for (Contact& contact : contacts) {
    const double together = of(contact.key), strength = is_palm(contact.key) ? hand.palm : hand.finger;
    const double part = together > 0.0 ? shared_depth(contact) / together : 1.0;
    contact.strength = part > 0.0 ? part * strength : strength;
    contact.inverse_mass = 1.0 / (is_palm(contact.key) ? hand.palm_mass : hand.finger_mass);
    contact.restitution = hand.restitution;
  }
}

}  // namespace mrhi
