#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "light.h"
#include "skin.h"

namespace mrhi {

/// The folds that bending leaves on the side of the palm: across the fingers at their joints, and the palm's
/// three. Narrow strips upon a skin's triangles, which are too few to be coloured so finely. Immutable.
class SkinCreases {
 public:
  explicit SkinCreases(const Skin& skin);

  /// A corner of the strips' triangles, counter-clockwise seen from outside.
  struct Corner {
    Vector3 place;  ///< in world [m]
    Rgb colour;
  };
  /// Upon a surface of that skin, in its vertices' colours and darker.
  void pose(const SkinSurface& surface, const std::vector<Rgb>& colours, std::vector<Corner>& corners) const;

 private:
  /// Where a crease crosses an edge of a triangle, the share of the way from vertex a to b.
  struct Crossing {
    std::uint32_t a, b;
    float share;
    float half_width;  // [m]
  };
  template <typename Crease>
  void add(const Skin& skin, const Crease& crease);

  std::vector<std::array<Crossing, 2>> parts_;  // one in each triangle that is crossed
};

}  // namespace mrhi
