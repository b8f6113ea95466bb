#pragma once

#include <cstdint>
#include <vector>

#include "light.h"
#include "skin.h"

namespace mrhi {

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
