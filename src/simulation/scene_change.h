#pragma once

#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// The state of a simulation of `before` as that of one of `after`. A body that both have by name keeps its
/// pose, momentum, contacts with their memory, and interactions to the bit; bodies that both have must be in
/// the same order. All are awake. A body that only `after` has is at its start and has appeared there.
SimulationState carried_over(const SimulationState& state, const Scene& before, const Scene& after);

/// Converts the last result likewise, without its events.
FrameResult carried_over(const FrameResult& result, const Scene& before, const Scene& after);

/// Sets the material of bodies that follow the parameters. Throws std::invalid_argument that names a body
/// whose own values conflict with it; the scene is then unchanged.
void set_default_material(const Material& material, Scene& scene);

}  // namespace mrhi
