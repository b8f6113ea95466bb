#pragma once

#include <vector>

#include "mr_hand_interaction/simulation.h"

namespace mrhi::real_grasps {

/// Adds, of each finger or palm that presses as the frame ends, how hard [N]: the sum of its contacts'
/// forces. Contacts struck in the frame are left out: what they are pressed with is not known.
void add_finger_forces(const FrameResult& result, std::vector<double>& forces);

}  // namespace mrhi::real_grasps
