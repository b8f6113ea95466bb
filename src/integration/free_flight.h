#pragma once

#include "mr_hand_interaction/integration/body_state.h"

namespace mrhi {

/// Advances a free body by `step` seconds under gravity [m/s^2] alone. Momenta change by gravity only; the
/// path of the centre is the exact parabola; orientation and energy follow Euler's equations to rounding at
/// any step. Jointed bodies are skipped (src/joints).
void free_flight(const Body& body, const Vector3& gravity, double step, BodyState& state);

/// Rotation of a body in a step: negligible, short enough for series, or long.
enum class Turn { none, short_one, long_one };
Turn turn_of(double quickness, const Vector3& angular_momentum, double step);
double quickness(const Body& body);  ///< for turn_of [1/(kg^2 m^4)]
/// Rotates the orientation by any amount.
void turn_far(const Body& body, const Vector3& angular_momentum, double step, Quaternion& orientation);

}  // namespace mrhi
