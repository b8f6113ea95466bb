#pragma once

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Of a distance field, by central differences.
template <typename Field>
Vector3 gradient(const Field& distance, const Vector3& point) {
  constexpr double kStep = 1e-4;  // [m]
  Vector3 g;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 step = kStep * Vector3::Unit(axis);
    g[axis] = (distance(point + step) - distance(point - step)) / (2.0 * kStep);
  }
  return g;
}

}  // namespace mrhi
