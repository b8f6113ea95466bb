#pragma once

#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// Adds the bodies and joints of `part`. Throws std::invalid_argument for a name that is taken.
void append(const Scene& part, Scene& scene);

}  // namespace mrhi
