#pragma once

#include <array>
#include <vector>

#include "mr_hand_interaction/scene/shape.h"
#include "rendering/skin.h"
#include "rendering/skin_rig.h"

namespace mrhi {

/// The fraction of a point of the rest hand's skin that each bone carries; the sum is 1. At a joint the bend
/// carries most, over a shorter distance at the back than at the inside, so that a bent finger keeps its
/// thickness.
std::array<double, kSkinBones> skin_weights(const Vector3& point);

/// How far the point belongs to each capsule, 0 to 1: to phalanges by their bones' weights, to the palm by
/// its distance.
std::array<float, kCapsules> capsule_shares(const Vector3& point);

/// How far a place on the rest hand's skin is a nail, and how far the edge of one, 0 to 1.
struct SkinNail {
  double nail = 0.0, edge = 0.0;
};
SkinNail skin_nail(const Vector3& vertex);

SkinModel::Look skin_look(const Vector3& vertex);

/// The folds on the side of the palm: across the fingers at their joints, and the palm's three.
std::vector<std::array<SkinModel::Crossing, 2>> skin_creases(const TriangleMesh& skin);

}  // namespace mrhi
