#pragma once

#include <array>
#include <vector>

#include "mr_hand_interaction/scene/shape.h"
#include "rendering/skin.h"
#include "skin_shape.h"

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

/// `creases`: their colour too, of which few triangles would make blots.
SkinModel::Look skin_look(const Vector3& vertex, bool creases);

/// How deep a place lies in one of the folds on the side of the palm, 0 to 1: across the fingers at their
/// joints, and the palm's three.
double skin_crease(const Vector3& vertex);
/// The nearest place on the line of a fold that passes within `margin` [m], else the vertex itself.
Vector3 onto_crease(const Vector3& vertex, double margin);

}  // namespace mrhi
