#pragma once

#include "marker_layers.h"

namespace mrhi {

/// Height of what shadows fall on: the highest level top of a wide fixture under all that is free; else
/// z = 0.1 m, where rviz has its grid, or lower where something is free there.
double ground_height(const Scene& scene);

/// The shadows of hands and of the first free bodies, straight below them on the ground: the higher a thing
/// is, the softer and fainter.
void add_shadows(const Scene& scene, const SimulationState& state, const FrameResult& result, double ground,
                 MarkerLayer& layer);

}  // namespace mrhi
