#pragma once

#include "mr_hand_interaction/integration/body_state.h"

namespace mrhi {

/// Moves a free body by `step` seconds under gravity [m/s^2] alone. Momenta are exact at any step; the path
/// of the centre is the exact parabola; orientation follows Euler's equations with a fourth-order
/// Runge-Kutta-Munthe-Kaas step (Munthe-Kaas 1998).
void free_flight(const Body& body, const Vector3& gravity, double step, BodyState& state);

}  // namespace mrhi
