#pragma once

#include <cstddef>

#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// Takes a body out that no joint holds; joints go on to mean the same ones.
void remove_body(std::size_t body, Scene& scene);

}  // namespace mrhi
