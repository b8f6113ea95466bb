#pragma once

#include "mr_hand_interaction/collision/body_manifold.h"
#include "oriented_shapes.h"

namespace mrhi {

/// Two boxes by the separating axis theorem (Gottschalk, Lin & Manocha 1996), the faces that meet clipped by
/// Sutherland & Hodgman 1974; where edges cross, a single point.
Manifold box_box(const OrientedBox& a, const OrientedBox& b, double margin);

}  // namespace mrhi
