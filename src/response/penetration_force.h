#pragma once

#include "contact_step.h"
#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/integration/body_state.h"

namespace mrhi {

/// A pressed object leaves a phalanx no faster than this: the spring gives back ever less of its force as the
/// two part, none at this speed. It is what damps a held object; it acts only where something touches, and
/// never pulls [m/s].
/// Without the fade scene (a) squeezed by 5 mm is shot away at 0.64 m/s as four fingers leave; with it at
/// 0.10 (docs/contact.md).
constexpr double kReleaseSpeed = 0.1;

/// 1 / kReleaseSpeed where contact/release_fade is on, else 0: the spring gives back all that it has taken
/// [s/m].
constexpr double release_fade(bool on) {
  return on ? 1.0 / kReleaseSpeed : 0.0;
}

/// While slipping, a contact sticks again once friction needs less than this part of what sliding gives.
constexpr double kStickAgain = 0.9;

/// Normal part of the penetration force, towards the inside of the object (Eqs. 16, 17) [N]; depth is from
/// where the phalanx's surface entered, `normal_velocity` as in Eq. 8, `fade` of release_fade().
double normal_force(double stiffness, double depth, double normal_velocity, double fade);

/// What Coulomb's law leaves of the tangential spring force (Eqs. 18-20), and whether the contact slips.
struct Tangential {
  Vector3 force;
  Friction friction;
};
Tangential coulomb(const Vector3& spring_force, double normal_force, const Material& material,
                   Friction before);

/// Of the motion along the surface while a contact sticks, as a part of critical damping.
constexpr double kTangentialDamping = 0.5;

/// One contact of the penetration phase: sets its force, drags its god object to the rim of the friction cone
/// where it slips, and returns the force on the object [N]. `damping` along the surface [N s/m] counts inside
/// the cone only.
Vector3 penetration_force(const Body& body, const BodyState& state, double damping, double fade,
                          Contact& contact);

/// The penetration phase: the forces of all contacts act for one step. Without contact/damping
/// (kTangentialDamping) and contact/release_fade (kReleaseSpeed) it is the paper to the letter.
void penetration_phase(const ContactConfiguration& configuration, ContactStep& step);

}  // namespace mrhi
