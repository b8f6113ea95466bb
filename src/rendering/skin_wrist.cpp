#include "skin_wrist.h"

#include <algorithm>
#include <set>
#include <utility>

namespace mrhi {
namespace {

constexpr double kLidDepth = 0.01;  // from the rim to the lid's middle [m]

}  // namespace

/// The rim is one loop of edges. From its middle: the loop is jagged, and a fan from one of its own corners
/// would stand out between its teeth.
SkinWrist::SkinWrist(const Skin& skin) : skin_(skin) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (const auto& t : skin.triangles()) {
    const Triangle triangle{static_cast<std::uint32_t>(t[0]), static_cast<std::uint32_t>(t[1]),
                            static_cast<std::uint32_t>(t[2])};
    const bool fades =
        std::any_of(triangle.begin(), triangle.end(), [this](std::uint32_t v) { return opacity(v) < 1.0f; });
    (fades ? fading_ : opaque_).push_back(triangle);
    for (std::size_t i = 0; i < 3 && !fades; ++i) {
      const std::uint32_t a = triangle[i], b = triangle[(i + 1) % 3];
      if (edges.erase({b, a}) == 0) edges.insert({a, b});
    }
  }
  for (const auto& [a, b] : edges) {
    opaque_.push_back({static_cast<std::uint32_t>(skin.size()), b, a});
    rim_.push_back(a);
  }
}

/// Within the wrist: level with the rim, flat stretches of skin would be above the lid. In the light that its
/// side of the hand is in: the end of a wrist looks round.
void SkinWrist::add_lid(SkinSurface& surface, std::vector<Rgb>& colours) const {
  Vector3 rim = Vector3::Zero(), faded = Vector3::Zero();
  Rgb colour = Rgb::Zero(), light = Rgb::Zero();
  for (const std::uint32_t vertex : rim_) {
    rim += surface.vertices[vertex] / static_cast<double>(rim_.size());
    colour += colours[vertex];
    light += light_on(surface.normals[vertex].cast<float>());
  }
  for (const Triangle& triangle : fading_)
    for (const std::uint32_t v : triangle)
      faded += surface.vertices[v] / (3.0 * static_cast<double>(fading_.size()));
  const Vector3 outward = (faded - rim).normalized();
  surface.vertices.push_back(rim + kLidDepth * outward);
  surface.normals.push_back(outward);
  colours.push_back((colour / light * light_on(outward.cast<float>())).min(1.0f));
}

}  // namespace mrhi
