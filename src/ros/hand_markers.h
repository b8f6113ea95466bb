#pragma once

#include <array>
#include <vector>

#include "../rendering/skin.h"
#include "marker_layers.h"
#include "mr_hand_interaction/ros/markers.h"

namespace mrhi {

/// Where hands are drawn.
struct HandLayers {
  MarkerLayer& hand;   ///< the rendered hand's skin, and apart from it the wrist's sides
  MarkerLayer& ghost;  ///< the tracked hand's skin where it is elsewhere
};

/// The rendered hand as the simulation has it. Ids from `first_id`, less than kIdsPerHand.
void add_simulated(const RenderedHand& rendered, int first_id, MarkerLayer& layer);

/// Farthest that the ends of two hands' phalanges are apart [m].
double farthest_apart(const Hand& a, const Hand& b);
/// Opacity of a ghost's vertex that is this far from the same vertex of the rendered hand [m].
float ghost_opacity(double distance, const PictureStyle& style);
/// Colour of a ghost's vertex with this normal, light included.
Rgb ghost_colour(const Vector3& normal, const PictureStyle& style);

/// Draws hands as triangles. One with bones missing has no skin: its capsules take the skin's place.
class HandMarkers {
 public:
  explicit HandMarkers(const Skin& skin);  ///< keeps a reference
  /// Ids from `first_id`, less than kIdsPerHand in each layer. Without `style.skins`, only capsules.
  void add(const RenderedHand& rendered, const Hand& tracked, const FrameResult& result,
           const SimulationState& state, const PictureStyle& style, int first_id, HandLayers layers);
  /// Takes the memory of markers that are done with, for the next ones.
  void recycle(std::vector<visualization_msgs::Marker>& markers);

 private:
  /// What is translucent hides nothing, and is drawn from the farthest marker's place to the nearest: in one
  /// marker the wrist's far side would stand before its near one.
  static constexpr int kWristSides = 6;
  using Triangles = std::vector<SkinWrist::Triangle>;
  visualization_msgs::Marker& add_triangles(int id, MarkerLayer& layer);
  void add_part(const Triangles& triangles, Side side, const Vector3& origin, int id, MarkerLayer& layer);
  void add_skin(const RenderedHand& rendered, int first_id, MarkerLayer& layer);
  void add_ghost(const Hand& rendered, const Hand& tracked, const PictureStyle& style, int id,
                 MarkerLayer& layer);
  /// On which side of the wrist, as seen along the forearm.
  std::size_t side_of_wrist(const SkinWrist::Triangle& triangle) const;

  const Skin &skin_, &outline_;
  const SkinPaint paint_;
  const SkinWrist wrist_;
  std::array<Triangles, kWristSides> sides_;
  SkinSurface surface_, ghost_, beneath_;  // kept for their memory, as are the rest
  std::vector<Rgb> colours_;
  std::vector<float> alphas_;
  std::vector<visualization_msgs::Marker> spare_;
};

}  // namespace mrhi
