#pragma once

#include "skin_rig.h"

namespace mrhi {

/// How much each bone carries of a point of the rest hand's skin; the sum is 1. At a joint the bend carries
/// most, over a shorter way at the back than at the inside, so that a bent finger keeps its thickness.
std::array<double, kSkinBones> skin_weights(const Vector3& point);

/// How far the point belongs to each capsule: to phalanges by their bones' weights, to the palm by its
/// distance.
std::array<float, kCapsules> capsule_shares(const Vector3& point);

}  // namespace mrhi
