#pragma once

#include <array>
#include <vector>

#include "light.h"
#include "mr_hand_interaction/rendering/rendered_hand.h"
#include "skin.h"

namespace mrhi {

struct SkinTone {
  Rgb skin = Rgb::Ones();                   ///< times the skin's own colours
  Rgb touching = Rgb(0.86f, 0.30f, 0.08f);  ///< where it presses
};

/// The colours of a hand's skin, light included: rviz draws coloured vertices unlit. Less light comes from
/// around where fingers cover each other or the palm (spheres as occluders). Immutable.
class SkinPaint {
 public:
  explicit SkinPaint(const Skin& skin) : skin_(skin) {}  ///< keeps a reference

  /// A colour for each vertex of the surface, which is that of the rendered hand: redder around where it
  /// presses, and the more so the harder.
  void paint(const RenderedHand& rendered, const SkinSurface& surface, std::vector<Rgb>& colours,
             const SkinTone& tone = {}) const;

 private:
  float redness(std::size_t vertex, const Vector3& place, const RenderedHand& rendered,
                const std::vector<int>& touched) const;
  const Skin& skin_;
};

}  // namespace mrhi
