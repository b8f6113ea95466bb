#pragma once

#include <cstddef>
#include <vector>

#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// Adds the bodies, joints, operators and tethers of `part`. Throws std::invalid_argument for a name that is
/// taken.
void append(const Scene& part, Scene& scene);

/// The body and all that hangs on it by joints, in the scene's order.
std::vector<std::size_t> hanging_on(std::size_t body, const Scene& scene);

/// Takes a body out with all that hangs on it; the joints that are left go on to mean the same bodies.
void remove_body(std::size_t body, Scene& scene);

}  // namespace mrhi
