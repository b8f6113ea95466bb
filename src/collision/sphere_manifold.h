#pragma once

#include <optional>

#include "mr_hand_interaction/collision/body_manifold.h"

namespace mrhi {

/// Closest features of a capsule in the shape's frame, if nearer than `margin`: closed form or mesh.
std::optional<ClosestFeatures> closest_on(const ManifoldShape& shape, const Capsule& capsule, double margin);

/// A sphere at `centre` against any shape: one point, named 0.
Manifold sphere_manifold(const Sphere& sphere, const Vector3& centre, const ManifoldShape& b,
                         const Pose& pose_b, double margin);

}  // namespace mrhi
