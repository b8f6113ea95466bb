#pragma once

#include <vector>

#include "mr_hand_interaction/collision/contact.h"
#include "mr_hand_interaction/integration/body_state.h"

namespace mrhi {

/// Inverse effective mass of a free body at the point `r` from its centre (Eq. 12; the tracked hand is
/// kinematic): K = I/m - [r]x I^-1 [r]x, symmetric positive definite [1/kg].
Matrix3 collision_matrix(double inverse_mass, const Matrix3& world_inverse_inertia, const Vector3& r);

/// Returns the largest eigenvalue of the symmetric matrix (tt ts; ts ss).
double max_eigenvalue(double tt, double ts, double ss);
/// Returns the largest eigenvalue of K perpendicular to the unit vector `n` [1/kg]; for n = 0 the trace,
/// which bounds all eigenvalues. Friction relaxed by its inverse does not overshoot in any direction.
double max_tangential_response(const Matrix3& k, const Vector3& n);

/// Changes the momenta of a body by `impulse` [N s] at `point` (Eq. 15 with its angular part).
void apply_impulse(const Vector3& impulse, const Vector3& point, BodyState& state);

/// Velocity of the hand's surface relative to the object's at the contact: c1' - c2' [m/s].
Vector3 relative_velocity(const Contact& contact, const Body& body, const BodyState& state);

/// An energy gain below this fraction of the exchanged energy is rounding.
constexpr double kGainTolerance = 1e-7;

/// A point of an impact under two laws, Newton's and one without restitution: impulses on the second body
/// [N s], and the first surface's velocity relative to the second before and after the impact [m/s].
struct ImpactLaws {
  Vector3 approach, newtons, after_newtons, plastic, after_plastic;
};

/// Returns the energy that the bodies gain in an impact beyond the work of the hands [J].
double energy_gained(const Vector3& approach, const Vector3& impulse, const Vector3& after);

/// Limits an impact to one that gains no energy, which restitution and friction together may do (Kane &
/// Levinson, Dynamics, 1985). Blends `newtons` towards the impact without restitution, which only dissipates.
/// If that gains energy too, where joints jam and no solution was found, blends towards no impact.
void keep_from_gaining(std::vector<ImpactLaws>& points);

/// First time from now at which a gap [m] with the given `rate` [m/s] and `acceleration` [m/s^2] closes; 0 if
/// it is closed already, infinite if never [s].
double time_to_close(double gap, double rate, double acceleration);

}  // namespace mrhi
