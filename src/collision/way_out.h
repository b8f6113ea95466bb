#pragma once

#include <optional>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// How far it is from `point` along the unit vector `direction` to where this line leaves the shape: negative
/// if that lies behind the point [m]. Shape's frame. Nothing if the line misses the shape, or for a mesh. Of
/// a convex shape the line is inside it for one interval in..out of t, x = point + t direction, and this is
/// the out.
std::optional<double> way_out(const Shape& shape, const Vector3& point, const Vector3& direction);

}  // namespace mrhi
