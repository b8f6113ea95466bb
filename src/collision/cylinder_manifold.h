#pragma once

#include "mr_hand_interaction/collision/body_manifold.h"
#include "oriented_shapes.h"

namespace mrhi {

/// A cylinder on a box or a cylinder: cap on face (four points of the rim), side on face (two), otherwise
/// one.
Manifold cylinder_box(const OrientedCylinder& a, const OrientedBox& b, double margin);
Manifold cylinder_cylinder(const OrientedCylinder& a, const OrientedCylinder& b, double margin);

}  // namespace mrhi
