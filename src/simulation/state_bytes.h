#pragma once

#include <string>

#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// All bits of a state, for a recording that begins while a simulation runs. Bytes can be read by the same
/// format version, on machines of the same byte order.
std::string to_bytes(const SimulationState& state);

/// Reads a state that a simulation of the scene can continue from. Throws std::invalid_argument for bytes
/// that are incomplete, of another format version, or do not fit the scene.
SimulationState state_from_bytes(const std::string& bytes, const Scene& scene);

/// True if the state's sizes, indices and unit quaternions are valid for the scene.
bool fits(const SimulationState& state, const Scene& scene);

}  // namespace mrhi
