#pragma once

#include <optional>

#include "closest_features.h"
#include "segment.h"

namespace mrhi {

/// The shortest translation that takes a segment, which overlaps the cylinder, out of it: distance <= 0.
ClosestFeatures leave_cylinder(const Segment& axis, const Cylinder& cylinder);

/// The place on the quarter x, y >= 0 of the ellipse (x/a)^2 + (y/b)^2 = 1, a >= b > 0, that is nearest,
/// among its neighbours, to a place below that quarter's curve with x >= 0. Nothing if that is the quarter's
/// end at y = 0.
std::optional<Eigen::Vector2d> nearest_on_ellipse(double a, double b, const Eigen::Vector2d& place);

}  // namespace mrhi
