#pragma once

#include <Eigen/Core>
#include <algorithm>

namespace mrhi {

using Rgb = Eigen::Array3f;  ///< 0 to 1

/// Towards the main light (unit).
inline Eigen::Vector3f main_light() {
  return {0.3505f, -0.4506f, 0.8211f};
}

/// What a white surface with this normal (world, unit) sends back: one light from above, one faint from
/// below, light from all around, of which the share `around` arrives. Fixed in world, so that what is still
/// keeps its colours while the view turns. A channel may exceed 1.
///
///     main:      (n.l + wrap) / (1 + wrap), >= 0 (wrapped diffuse light: red goes farther round than blue)
///     all round: below + (1/2 + n_z/2) (above - below), as of a sky and a floor
inline Rgb light_on(const Eigen::Vector3f& normal, float around = 1.0f) {
  const Eigen::Vector3f main = main_light(), fill(-0.5514f, -0.4511f, -0.7018f);  // unit
  const Rgb main_colour(0.40f, 0.39f, 0.37f), fill_colour(0.20f, 0.19f, 0.18f);
  const Rgb above(0.62f, 0.63f, 0.65f), below(0.55f, 0.51f, 0.49f);
  const Rgb wrap(0.45f, 0.30f, 0.25f);  // light that goes on in the skin past where it would end
  const Rgb direct = (normal.dot(main) + wrap) / (1.0f + wrap);
  const Rgb ambient = below + (0.5f + 0.5f * normal.z()) * (above - below);
  const float from_below = 0.6f * std::max(0.0f, normal.dot(fill) + 0.4f);
  return main_colour * direct.max(0.0f) * (0.4f + 0.6f * around) +
         (ambient + fill_colour * from_below) * around;
}

}  // namespace mrhi
