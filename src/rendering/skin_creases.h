#pragma once

#include <vector>

#include "light.h"
#include "skin.h"

namespace mrhi {

/// The folds that bending leaves on the side of the palm: across the fingers at their joints, and the palm's
/// three. Narrow strips upon a skin's triangles, which are too few to be coloured so finely. Immutable.
class SkinCreases {
 public:
  explicit SkinCreases(const Skin& skin) : skin_(skin) {}  ///< keeps a reference

  /// A corner of the strips' triangles, counter-clockwise seen from outside.
  struct Corner {
    Vector3 place;  ///< in world [m]
    Rgb colour;
  };
  /// Upon a surface of that skin, in its vertices' colours and darker.
  void pose(const SkinSurface& surface, const std::vector<Rgb>& colours, std::vector<Corner>& corners) const;

 private:
  const Skin& skin_;
};

}  // namespace mrhi
