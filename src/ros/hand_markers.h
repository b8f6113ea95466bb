#pragma once

#include <vector>

#include "marker_layers.h"
#include "mr_hand_interaction/rendering/skin_paint.h"

namespace mrhi {

/// Where hands are drawn.
struct HandLayers {
  MarkerLayer& hand;      ///< the rendered hand's skin, a triangle list per hand
  MarkerLayer& ghost;     ///< the tracked hand's skin where it is elsewhere
  MarkerLayer& capsules;  ///< the rendered hand as the simulation has it
};

/// Draws hands. One with bones missing has no skin: its capsules take the skin's place.
class HandMarkers {
 public:
  HandMarkers();
  /// Ids from `first_id`, less than kIdsPerHand in each layer.
  void add(const RenderedHand& rendered, const Hand& tracked, int first_id, HandLayers layers);

 private:
  void add_skin(Side side, int id, MarkerLayer& layer) const;
  void add_ghost(const Hand& tracked, int id, MarkerLayer& layer);

  const Skin& skin_;
  SkinPaint paint_;
  SkinSurface surface_, ghost_;  // kept for their memory
  std::vector<Rgb> colours_;
  std::vector<float> alphas_;
};

}  // namespace mrhi
