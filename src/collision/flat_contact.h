#pragma once

#include "mr_hand_interaction/collision/body_manifold.h"
#include "oriented_shapes.h"

namespace mrhi {

/// Depth of the deepest point; -1e300 if there is none.
double deepest_depth(const Manifold& manifold);

/// What touches by a cap or a box's face, if the axis n of least overlap (out of b towards a, `separation` <
/// 0) is near the normal of one.
struct FlatContact {
  Manifold manifold;
  bool found = false;    ///< as deep as the axis says
  bool certain = false;  ///< no axis can be better, whichever others there are
};
FlatContact flat_contact(const OrientedCylinder& a, const OrientedBox& b, const Vector3& n, double separation,
                         double margin);
FlatContact flat_contact(const OrientedCylinder& a, const OrientedCylinder& b, const Vector3& n,
                         double separation, double margin);

}  // namespace mrhi
