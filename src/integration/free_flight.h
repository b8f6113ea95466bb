#pragma once

#include "mr_hand_interaction/integration/body_state.h"

namespace mrhi {

/// Advances a free body by `step` seconds under gravity [m/s^2] alone. Momenta change by gravity only; the
/// path of the centre is the exact parabola; orientation and energy follow Euler's equations to rounding at
/// any step. Jointed bodies are skipped (src/joints).
void free_flight(const Body& body, const Vector3& gravity, double step, BodyState& state);

}  // namespace mrhi
