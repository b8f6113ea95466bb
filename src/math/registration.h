#pragma once

#include <cstddef>
#include <optional>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Similarity transform between two point sets: each point maps to `to + scale rotation (point - from)`.
struct Registration {
  Matrix3 rotation = Matrix3::Identity();
  double scale = 1.0;
  Vector3 from = Vector3::Zero(), to = Vector3::Zero();  ///< means of both point sets [m]
};

/// Least-squares fit (Umeyama 1991) of `size` pairs of points of a hand. Empty if they do not determine it:
/// fewer than three, or collinear.
std::optional<Registration> registered(const Vector3* from, const Vector3* to, std::size_t size);

}  // namespace mrhi
