#pragma once

#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/response/contact_model.h"

namespace mrhi {

/// Inverse effective mass of a free body at the point `r` from its centre (Eq. 12; the tracked hand is
/// kinematic): K = I/m - [r]x I^-1 [r]x, symmetric positive definite [1/kg].
Matrix3 collision_matrix(const Body& body, const Quaternion& orientation, const Vector3& r);

/// Impulse along n that turns the approach velocity `normal_velocity` (< 0) into -restitution times it
/// (Eqs. 9-14) [N s]; on the object it acts along -n.
double newton_impulse(double normal_velocity, double restitution, const Matrix3& k, const Vector3& normal);

/// Changes the momenta of a body by `impulse` [N s] at `point` (Eq. 15 with its angular part).
void apply_impulse(const Vector3& impulse, const Vector3& point, BodyState& state);

/// Velocity of the hand's surface relative to the object's at the contact: c1' - c2' [m/s].
Vector3 relative_velocity(const Contact& contact, const Body& body, const BodyState& state);

/// True if the surfaces touch or will within `step`, approach each other, and have not struck yet.
bool strikes_now(const Contact& contact, double normal_velocity, double step);

enum class ImpactFriction { none, coulomb };

/// The impulse phase: Newton's impact law along the normal, once per approach, for all contacts that strike
/// in this step together: each one's relative velocity becomes at least -restitution times what it was, with
/// impulses that only push. `coulomb`: sliding at the point is stopped as far as static friction times the
/// normal impulse goes.
void impulse_phase(ContactStep& step, ImpactFriction friction);

/// Call when free flight has moved the bodies: takes back what an impact's change of velocity did before its
/// time of impact, so that an object is not pushed ahead of the hand.
void delay_impacts(ContactStep& step);

}  // namespace mrhi
