#pragma once

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

/// When a gap [m] that changes by `rate` [m/s], which itself changes by `acceleration`, is closed: the first
/// time from now on, 0 if it is closed already, infinite if never [s].
double time_to_close(double gap, double rate, double acceleration);

}  // namespace mrhi
