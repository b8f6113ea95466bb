#pragma once

#include <vector>

#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/integration/body_state.h"

namespace mrhi {

/// Inverse effective mass of a free body at the point `r` from its centre (Eq. 12; the tracked hand is
/// kinematic): K = I/m - [r]x I^-1 [r]x, symmetric positive definite [1/kg].
Matrix3 collision_matrix(double inverse_mass, const Matrix3& world_inverse_inertia, const Vector3& r);

/// Changes the momenta of a body by `impulse` [N s] at `point` (Eq. 15 with its angular part).
void apply_impulse(const Vector3& impulse, const Vector3& point, BodyState& state);

/// Velocity of the hand's surface relative to the object's at the contact: c1' - c2' [m/s].
Vector3 relative_velocity(const Contact& contact, const Body& body, const BodyState& state);

/// A gain of energy up to this part of what is exchanged is rounding.
constexpr double kNoGain = 1e-7;

/// One strike of a blow, as two laws have it: impulses on the second body [N s], and its point's velocity
/// against it before the blow, and after it by each law [m/s].
struct TwoBlows {
  Vector3 approach, newtons, after_newtons, least, after_least;
};

/// What a blow has given to the bodies beyond the work of the hands [J].
double energy_gained(const Vector3& approach, const Vector3& given, const Vector3& after);

/// Newton's restitution and Coulomb's friction together may make energy (Kane & Levinson, Dynamics, 1985).
/// Moves `newtons` as far towards the blow without restitution, which only takes, as it needs to make none.
/// Where that one makes some too, as what joints hold may jam and it has not been found, towards no blow.
void keep_from_gaining(std::vector<TwoBlows>& strikes);

/// When a gap [m] that changes by `rate` [m/s], which itself changes by `acceleration`, is closed: the first
/// time from now on, 0 if it is closed already, infinite if never [s].
double time_to_close(double gap, double rate, double acceleration);

}  // namespace mrhi
