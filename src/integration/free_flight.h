#pragma once

#include "mr_hand_interaction/integration/body_state.h"

namespace mrhi {

/// Moves a free body by `step` seconds under gravity [m/s^2] alone. Momenta do not change by a bit; the path
/// of the centre is the exact parabola; orientation follows Euler's equations to rounding at any step, energy
/// included (free_rotation.h). What hangs on joints is left to them (src/joints).
void free_flight(const Body& body, const Vector3& gravity, double step, BodyState& state);

}  // namespace mrhi
