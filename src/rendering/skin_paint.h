#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "light.h"
#include "mr_hand_interaction/rendering/rendered_hand.h"
#include "mr_hand_interaction/simulation_state.h"
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

/// Flattens the pads of a hand's skin against what they press: skin that is nearer to the touched plane than
/// the pad's compression lies on it, and skin up to three times as far comes nearer. The compression grows
/// with the force as a fingertip's does, to kDeepestPress.
void press_flat(const std::vector<Contact>& contacts, const SimulationState& state, std::uint32_t hand,
                const Skin& skin, SkinSurface& surface);

constexpr double kDeepestPress = 0.0018;  ///< [m]

/// A skin's triangles by how they are drawn: opaque up to a rim, and fading from there to nothing along the
/// wrist. A lid about one more vertex, skin.size(), closes the opaque part: who looks through the wrist sees
/// no inside. Immutable.
class SkinWrist {
 public:
  explicit SkinWrist(const Skin& skin);  ///< keeps a reference

  using Triangle = std::array<std::uint32_t, 3>;
  const std::vector<Triangle>& opaque() const { return opaque_; }  ///< the lid included
  const std::vector<Triangle>& fading() const { return fading_; }
  /// How much of a vertex is seen: 1 everywhere but at the wrist.
  float opacity(std::size_t vertex) const {
    return vertex < skin_.size() ? 1.0f - skin_.model().looks[vertex].wrist : 1.0f;
  }
  /// Adds the lid's vertex to a surface of the skin and its colours.
  void add_lid(SkinSurface& surface, std::vector<Rgb>& colours) const;

 private:
  const Skin& skin_;
  std::vector<Triangle> opaque_, fading_;
  std::vector<std::uint32_t> rim_;
};

}  // namespace mrhi
