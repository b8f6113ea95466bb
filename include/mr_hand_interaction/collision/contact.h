#pragma once

#include <cstdint>
#include <optional>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Identifies touching surfaces. Ordered, so that contacts are always processed in the same order. Fields
/// start with the least significant, so a compiler reads the order in one load.
struct ContactKey {
  std::uint8_t point;    ///< 0; also 1 if a capsule lies along a face and touches at two points
  std::uint8_t shape;    ///< of the body
  std::uint8_t capsule;  ///< of the hand
  std::uint8_t hand;     ///< index of the hand's track
  std::uint16_t body;    ///< index in Scene::bodies

  friend bool operator<(const ContactKey& a, const ContactKey& b) { return a.order() < b.order(); }
  friend bool operator==(const ContactKey& a, const ContactKey& b) { return a.order() == b.order(); }
  bool same_pair(const ContactKey& other) const { return order() >> 8 == other.order() >> 8; }
  bool same_phalanx(const ContactKey& other) const { return order() >> 16 == other.order() >> 16; }
  std::uint64_t order() const {
    return std::uint64_t(point) | (std::uint64_t(shape) << 8) | (std::uint64_t(capsule) << 16) |
           (std::uint64_t(hand) << 24) | (std::uint64_t(body) << 32);
  }
};

/// Eq. 8's three cases.
enum class Approach : std::uint8_t { separating, resting, colliding };

/// State of a contact's friction. Creeping surfaces slip, but too slowly for friction to fall from static to
/// dynamic.
enum class Friction : std::uint8_t { sticking, creeping, slipping };

/// Part of a contact that persists while the surfaces touch.
struct ContactMemory {
  ContactKey key{};
  Friction friction = Friction::sticking;
  bool struck = false;   ///< the impact of this approach is over
  bool ignored = false;  ///< overlapped when hand or body was spawned: no contact until they have separated
  Vector3 god_object = Vector3::Zero();     ///< c, on the object's surface, body frame
  Vector3 entry_normal = Vector3::UnitZ();  ///< normal of the face of entry, body frame
  Vector3 touched_from = Vector3::UnitZ();  ///< n at first touch, palm frame
  double axis_parameter = 0.0;              ///< s of the contact point on the phalanx's axis
  bool at_edge = false;                     ///< at an edge of the object
  double depth = 0.0;                       ///< n.(c - p): > 0 penetrates [m]
  /// Elastic rotation of the phalanx about n relative to the object since first touch [rad].
  double twist = 0.0;
  double engaged = 0.0;             ///< part of the pad's final stiffness in the last step, 0 to 1
  double compliance = 0.0;          ///< depth without force, of a finger that closes on the body [m]
  Vector3 force = Vector3::Zero();  ///< of the last step [N]

  bool touching() const { return depth > 0.0 && !ignored; }
  double pressed() const { return depth - compliance; }
};

/// A contact of a hand (body 1) with an object (body 2): the persistent god object, the geometry in this
/// step, and the response. World frame unless noted; n points from the object to the hand; impulse and force
/// act on the OBJECT.
struct Contact : ContactMemory {
  Vector3 point = Vector3::Zero();       ///< c in world
  Vector3 normal = Vector3::UnitZ();     ///< n
  Vector3 hand_point = Vector3::Zero();  ///< p: surface point of the phalanx that entered at c
  Vector3 lever = Vector3::Zero();       ///< offset from n of p moved back to the surface along its path [m]
  Vector3 hand_velocity = Vector3::Zero();  ///< of p [m/s]
  double hand_spin = 0.0;                   ///< n.w of the phalanx [rad/s]
  Vector3 axis = Vector3::Zero();           ///< of the phalanx, from start to end [m]
  double radius = 0.0;                      ///< of the phalanx [m]
  double patch = 0.0;                       ///< radius of the touching patch [m]
  double grip = 1.0;                        ///< friction over that on a face, for this stretch
  double share = 1.0;                       ///< of the phalanx's stiffness; the shares of its points sum to 1
  double strength = HandStrength::kUnlimited;  ///< maximum normal force of this point [N]
  double inverse_mass = 0.0;                   ///< of the phalanx in an impact, effective [1/kg]
  double carrier_inverse_mass = 0.0;           ///< of the hand's operator there, along n, effective [1/kg]
  std::optional<double> restitution;           ///< of an impact, 0 to 1; unset: the object's
  Vector3 impulse = Vector3::Zero();           ///< of an impact in this step [N s]
  double time_of_impact = 0.0;                 ///< of that impact, from the start of the step [s]
  double torque = 0.0;                         ///< about n, of the soft finger [N m]
  double peak_force = 0.0;  ///< of a frame's report: its phalanx's largest force in one of the steps [N]
};

}  // namespace mrhi
