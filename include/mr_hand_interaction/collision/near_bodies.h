#pragma once

#include <vector>

#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// Indices, ascending, of all bodies, fixtures too, that may be nearer to the hand than `margin` [m].
std::vector<int> near_bodies(const Hand& hand, const Scene& scene, const std::vector<BodyState>& bodies,
                             double margin);

}  // namespace mrhi
