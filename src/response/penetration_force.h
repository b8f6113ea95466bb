#pragma once

#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "release.h"

namespace mrhi {

/// While slipping, a contact sticks again once friction needs less than this part of what sliding gives.
constexpr double kStickAgain = 0.9;

/// Normal part of the penetration force, towards the inside of the object (Eqs. 16, 17) [N]; depth is from
/// where the phalanx's surface entered, `normal_velocity` as in Eq. 8.
double normal_force(double stiffness, double depth, double normal_velocity);

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
Vector3 penetration_force(const Body& body, const BodyState& state, double damping, Contact& contact);

/// The penetration phase: the forces of all contacts act for one step.
void penetration_phase(ContactStep& step);

}  // namespace mrhi
