#pragma once

#include "mr_hand_interaction/integration/body_state.h"
#include "short_turn.h"

namespace mrhi {

/// Moves a free body by `step` seconds under gravity [m/s^2] alone. Momenta do not change by a bit; the path
/// of the centre is the exact parabola; orientation follows Euler's equations to rounding at any step, energy
/// included (free_rotation.h). What hangs on joints is left to them (src/joints).
void free_flight(const Body& body, const Vector3& gravity, double step, BodyState& state);

/// What it is made of. The centre alone:
void fly_on(double mass, const Vector3& gravity, double step, BodyState& state);
/// What turns a body in a step: nothing worth it; a short turn (turn_shortly), with what it needs to know; or
/// any.
enum class Turn { none, short_one, long_one };
Turn turn_of(double quickness, const Vector3& angular_momentum, double step);
double quickness(const Body& body);  ///< for turn_of [1/(kg^2 m^4)]
Spinner<double> spinner_of(const Body& body);
Turning<double> turning_of(const BodyState& state, double step);
void turn_far(const Body& body, const Vector3& angular_momentum, double step, Quaternion& orientation);

}  // namespace mrhi
