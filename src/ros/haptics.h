#pragma once

#include <mr_hand_interaction/HapticsArray.h>
#include <std_msgs/Header.h>

#include <vector>

#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// What every hand feels by `contacts` (sorted by key): an entry for each phalanx and object that touch or
/// strike.
mr_hand_interaction::HapticsArray haptics_message(const Scene& scene, const SimulationState& state,
                                                  const std::vector<Contact>& contacts,
                                                  const std_msgs::Header& header);

}  // namespace mrhi
