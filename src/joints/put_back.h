#pragma once

#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// Puts a body where it started, with all that hangs together with it by joints.
void put_back(std::size_t body, const Scene& scene, SimulationState& state);

}  // namespace mrhi
