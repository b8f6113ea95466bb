#pragma once

#include <array>
#include <vector>

#include "light.h"
#include "skin.h"

namespace mrhi {

/// The colours of a hand's skin, light included: rviz draws coloured vertices unlit. Less light comes from
/// around where fingers cover each other or the palm (spheres as occluders). Immutable.
class SkinPaint {
 public:
  explicit SkinPaint(const Skin& skin);  ///< keeps a reference

  /// A colour for each vertex of the surface, which is that of `hand`.
  void paint(const Hand& hand, const SkinSurface& surface, const std::array<bool, kCapsules>& touching,
             std::vector<Rgb>& colours) const;

  static Rgb touching_colour() { return {0.86f, 0.30f, 0.08f}; }

 private:
  struct Tint {
    Rgb colour;
    int capsule;  ///< that the vertex belongs to most
  };
  const Skin& skin_;
  std::vector<Tint> tints_;
};

}  // namespace mrhi
