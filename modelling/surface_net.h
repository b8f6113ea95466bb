#pragma once

#include <functional>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

using DistanceField = std::function<double(const Vector3&)>;  ///< [m], negative inside

/// The closed surface where the field is zero, with outward normals and edges of about `cell` [m]: a naive
/// surface net (Gibson 1998), evened out. The surface must lie within the box.
TriangleMesh surface_net(const DistanceField& distance, const Vector3& lowest, const Vector3& highest,
                         double cell);

}  // namespace mrhi
