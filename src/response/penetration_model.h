#pragma once

#include "contact_step.h"
#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/integration/body_state.h"

namespace mrhi {

/// Largest speed at which a compressed object leaves a phalanx [m/s]. As the two separate, the spring's force
/// fades, to none at this speed. The fade damps a held object, acts only in contact, and never pulls.
///
/// Without the fade, scene (a) squeezed by 5 mm is shot away at 0.64 m/s when four fingers release it; with
/// it at 0.10 (docs/contact.md).
constexpr double kReleaseSpeed = 0.1;

/// 1 / kReleaseSpeed if contact/release_fade is on, else 0: the spring then returns all its energy [s/m].
constexpr double release_fade(bool on) {
  return on ? 1.0 / kReleaseSpeed : 0.0;
}

/// A slipping contact sticks again once the friction that it needs is below this fraction of the sliding
/// friction.
constexpr double kRestickRatio = 0.9;

/// Normal part of the penetration force, into the object (Eqs. 16, 17) [N]. Depth is from where the phalanx's
/// surface entered, `normal_velocity` as in Eq. 8, `fade` from release_fade().
double normal_force(double stiffness, double depth, double normal_velocity, double fade);

/// The tangential spring force limited by Coulomb's law (Eqs. 18-20), and whether the contact slips.
struct Tangential {
  Vector3 force;
  Friction friction;
};
Tangential coulomb(const Vector3& spring_force, double normal_force, const Material& material,
                   Friction before);

/// Damping of tangential motion while a contact sticks, over critical damping.
constexpr double kTangentialDamping = 0.5;

/// Displacement of the phalanx's point from the god object, along the surface [m].
inline Vector3 stretch_of(const Contact& contact) {
  const Vector3 reach = contact.hand_point - contact.point;
  return reach - contact.normal.dot(reach) * contact.normal;
}

/// Force of a spring along the surface and of the `drag` beside it, limited by Coulomb's law under the normal
/// force `load` [N]. Where the contact slips, its god object moves to where the spring has just that force.
Vector3 tangential_force(const Material& material, double stiffness, const Vector3& drag, double load,
                         const BodyState& state, Contact& contact);

/// One contact of the penetration phase: sets its force, moves its god object to the rim of the friction cone
/// where it slips, and returns the force on the object [N]. `damping` acts along the surface, within the cone
/// [N s/m].
Vector3 penetration_force(const Body& body, const BodyState& state, double damping, double fade,
                          Contact& contact);

/// The penetration phase: the forces of all contacts act for one step. Without contact/damping
/// (kTangentialDamping) and contact/release_fade (kReleaseSpeed) it is exactly the paper's.
void penetration_phase(ContactStep& step);

}  // namespace mrhi
