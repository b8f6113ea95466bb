#pragma once

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// The rest hand's skin as it ships, in the frame of skin_distance() [m], and a coarser one. Made by
/// scripts/make_skin.
TriangleMesh rest_skin();
TriangleMesh rest_outline();

}  // namespace mrhi
