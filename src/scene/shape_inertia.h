#pragma once

#include <vector>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// Moments of inertia about the origin of solids of one density that weigh `mass` together [kg m^2]; what two
/// of them share counts twice. Zero if they have no volume.
Matrix3 inertia_of(const std::vector<PlacedShape>& shapes, double mass);

}  // namespace mrhi
