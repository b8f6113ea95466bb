#pragma once

#include <cstddef>
#include <string>

#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// A state as bytes that hold every bit of it, for a recording that begins while a simulation runs. They are
/// those of this version and of machines of the same byte order.
std::string to_bytes(const SimulationState& state);

/// Throws std::invalid_argument for bytes that are not whole, of another version, or of another scene, as far
/// as they show it. What is taken can be gone on from, whoever has written it: all that it names is there,
/// and no number is none.
SimulationState state_from_bytes(const std::string& bytes, const Scene& scene);

}  // namespace mrhi
