#pragma once

#include <cstddef>
#include <optional>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// What brings points closest to others: each goes to `to + scale rotation (point - from)`.
struct Registration {
  Matrix3 rotation = Matrix3::Identity();
  double scale = 1.0;
  Vector3 from = Vector3::Zero(), to = Vector3::Zero();  ///< means of both [m]
};

/// Least squares (Umeyama 1991) over `size` pairs of points of a hand. Nothing if they do not fix it: fewer
/// than three, or in one line.
std::optional<Registration> registered(const Vector3* from, const Vector3* to, std::size_t size);

}  // namespace mrhi
