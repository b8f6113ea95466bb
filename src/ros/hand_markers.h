#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "../rendering/skin_creases.h"
#include "../rendering/skin_paint.h"
#include "marker_layers.h"

namespace mrhi {

/// Where hands are drawn.
struct HandLayers {
  MarkerLayer& hand;   ///< the rendered hand's skin, and apart from it the wrist's sides and the creases
  MarkerLayer& ghost;  ///< the tracked hand's skin where it is elsewhere
};

/// The rendered hand as the simulation has it. Ids from `first_id`, less than kIdsPerHand.
void add_simulated(const RenderedHand& rendered, int first_id, MarkerLayer& layer);

/// Draws hands. One with bones missing has no skin: its capsules take the skin's place.
class HandMarkers {
 public:
  explicit HandMarkers(const Skin& skin);  ///< keeps a reference
  /// Ids from `first_id`, less than kIdsPerHand in each layer.
  void add(const RenderedHand& rendered, const Hand& tracked, int first_id, HandLayers layers);
  /// Light for the next time, after the picture of now has gone: a hand's shading is a frame old, where it
  /// touches is not.
  void repaint(const std::vector<RenderedHand>& rendered);
  /// Takes the memory of markers that are done with, for the next ones.
  void recycle(std::vector<visualization_msgs::Marker>& markers);

 private:
  /// What is translucent hides nothing, and is drawn from the farthest marker's place to the nearest: in one
  /// marker the wrist's far side would stand before its near one.
  static constexpr int kWristSides = 6;
  /// Three for each triangle, in an order that is counter-clockwise from outside for either side. What is no
  /// vertex is the middle of the rim.
  using Corners = std::array<std::vector<std::uint32_t>, 2>;
  /// A hand as it was last drawn.
  struct Drawn {
    std::uint32_t hand = 0;
    Side side = Side::right;
    Touching touching{};
    bool new_paint = false;
    SkinSurface surface;
    std::vector<Rgb> colours;
    Rgb lid = Rgb::Zero();  // the colour of its middle
  };
  visualization_msgs::Marker& add_triangles(int id, MarkerLayer& layer);
  void add_skin(const RenderedHand& rendered, Drawn& drawn, int id, MarkerLayer& layer);
  void paint(const RenderedHand& rendered, Drawn& drawn) const;
  /// Of the rim: its middle, and which way the wrist goes on from there.
  std::pair<Vector3, Vector3> middle_of_rim(const SkinSurface& surface) const;
  void add_part(const Drawn& drawn, const Corners& corners, const Vector3& origin, int id,
                MarkerLayer& layer);
  void add_creases(const Drawn& drawn, int id, MarkerLayer& layer);
  void add_ghost(const Hand& rendered, const Hand& tracked, int id, MarkerLayer& layer);

  using Chosen = std::function<bool(const std::array<int, 3>& triangle)>;
  static Corners corners_of(const Skin& skin, const Chosen& chosen);
  static Corners closed(Corners corners, std::vector<std::uint32_t>& rim);
  bool fades(const std::array<int, 3>& triangle) const;
  /// On which side of the wrist, as seen along the forearm.
  int side_of_wrist(const std::array<int, 3>& triangle) const;
  std::array<Corners, kWristSides> corners_of_wrist() const;

  const Skin &skin_, &outline_;
  const SkinPaint paint_;
  const SkinCreases creases_;
  std::vector<std::uint32_t> rim_;  // where the opaque skin ends
  const Corners skin_corners_;
  const std::array<Corners, kWristSides> wrist_corners_;
  const Corners outline_corners_;
  std::vector<Drawn> drawn_;     // by their place in the result
  SkinSurface ghost_, beneath_;  // kept for their memory, as are the rest
  std::vector<float> alphas_;
  std::vector<SkinCreases::Corner> folds_;
  std::vector<visualization_msgs::Marker> spare_;
};

}  // namespace mrhi
