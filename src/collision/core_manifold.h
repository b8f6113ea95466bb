#pragma once

#include <optional>

#include "mr_hand_interaction/collision/body_manifold.h"

namespace mrhi {

/// Closest features of a capsule in the shape's frame, if nearer than `margin`: closed form or mesh.
std::optional<ClosestFeatures> closest_on(const ManifoldShape& shape, const Capsule& capsule, double margin);

/// A ball or a capsule, given in the frame `pose_a`, against any shape: at two points where it lies along
/// something flat or straight (named 0 and 1, by the ends of its axis), otherwise at one (also 0 or 1 at an
/// end, 2 between). Within 2.5 degrees of a face over which part of it stands, by that face.
Manifold core_manifold(const Capsule& core, const Pose& pose_a, const ManifoldShape& b, const Pose& pose_b,
                       double margin);

}  // namespace mrhi
