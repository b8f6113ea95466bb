#pragma once

#include <vector>

#include "mr_hand_interaction/scene/body.h"

namespace mrhi {

/// Turns of a body of one box about its centre that leave its outline as it is, the identity first; of others
/// the identity alone.
std::vector<Quaternion> box_symmetries(const Body& body);

}  // namespace mrhi
