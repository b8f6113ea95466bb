#pragma once

#include "mesh_nearest.h"
#include "mr_hand_interaction/collision/closest_features.h"

namespace mrhi {

/// The shortest translation that takes a segment, which cuts the surface or lies inside, out by a face or an
/// edge along which the solid bulges; distance <= 0. Exact for a convex mesh. Elsewhere the way out has to
/// lead through the face or edge itself; what the segment meets farther on is not looked at. Where there is
/// none: out by the plane of the face `fallback`. A way that is `known` is the answer unless there is a
/// shorter one.
ClosestFeatures leave_mesh(const Segment& segment, const MeshSurface& surface, const MeshTree& tree,
                           int fallback, const ClosestFeatures* known = nullptr);

}  // namespace mrhi
