#pragma once

#include "mr_hand_interaction/integration/body_state.h"

namespace mrhi {

/// Moves a free body by `step` seconds under gravity [m/s^2] alone. Momenta do not change by a bit; the path
/// of the centre is the exact parabola; orientation follows Euler's equations to rounding at any step, energy
/// included . What hangs on joints is left to them (src/joints).
void free_flight(const Body& body, const Vector3& gravity, double step, BodyState& state);

/// How a body turns in a step: not worth mention; by so little that short series suffice; or by more.
enum class Turn { none, short_one, long_one };
Turn turn_of(double quickness, const Vector3& angular_momentum, double step);
double quickness(const Body& body);  ///< for turn_of [1/(kg^2 m^4)]
/// Turns the orientation by any amount.
void turn_far(const Body& body, const Vector3& angular_momentum, double step, Quaternion& orientation);

}  // namespace mrhi
