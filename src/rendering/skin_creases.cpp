#include "skin_creases.h"

namespace mrhi {
namespace {

constexpr double kAbove = 0.00015;     // the triangles, so as to be before them [m]
const Rgb kTint(0.85f, 0.77f, 0.74f);  // of the skin's colour

}  // namespace

void SkinCreases::pose(const SkinSurface& surface, const std::vector<Rgb>& colours,
                       std::vector<Corner>& corners) const {
  corners.clear();
  for (const auto& part : skin_.model().creases) {
    std::array<Vector3, 2> places, normals;
    std::array<Rgb, 2> tints;
    for (std::size_t i = 0; i < 2; ++i) {
      const auto& [a, b, fraction, half_width] = part[i];
      normals[i] = (surface.normals[a] + fraction * (surface.normals[b] - surface.normals[a])).normalized();
      places[i] =
          surface.vertices[a] + fraction * (surface.vertices[b] - surface.vertices[a]) + kAbove * normals[i];
      tints[i] = kTint * (colours[a] + fraction * (colours[b] - colours[a]));
    }
    const Vector3 along = (places[1] - places[0]).normalized();
    std::array<Corner, 4> strip;  // counter-clockwise
    for (std::size_t i = 0; i < 2; ++i) {
      const Vector3 aside = part[i].half_width * normals[i].cross(along);
      strip[i] = {places[i] - aside, tints[i]};
      strip[3 - i] = {places[i] + aside, tints[i]};
    }
    for (const std::size_t i : {0, 1, 2, 0, 2, 3}) corners.push_back(strip[i]);
  }
}

}  // namespace mrhi
