#pragma once

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Signed distance, roughly, from the rest hand's skin [m], negative inside: rounded cones smoothly united
/// (Quilez's polynomial minimum). Fingers have the capsules' surface on the side of the palm and are flatter
/// at the back.
double skin_distance(const Vector3& point);
/// With the creases and the edges of the nails sunk.
double detailed_skin_distance(const Vector3& point);

constexpr double kSleeveHem = -0.016;  ///< x of the rest hand, from where a sleeve covers the forearm [m]

/// Whether a place on the skin is the sleeve, and how far it is in the shade of the sleeve's hem, 0 to 1.
struct SkinSleeve {
  bool covers;
  double shade;
};
SkinSleeve skin_sleeve(const Vector3& point);
/// The nearest place on the line between skin and sleeve within `margin` [m], else the point itself.
Vector3 onto_hem(const Vector3& point, double margin);

/// A box around it.
struct SkinBox {
  Vector3 lowest, highest;
};
SkinBox skin_box();

/// Of a distance field, by central differences. (f(x + h e_i) - f(x - h e_i)) / 2 h: off by h^2 f''' / 6 and
/// by f's rounding over h.
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

/// Unit, outward.
inline Vector3 skin_normal(const Vector3& point) {
  return gradient(skin_distance, point).normalized();
}

}  // namespace mrhi
