#include <visualization_msgs/Marker.h>

#include <array>
#include <cmath>

#include "../rendering/light.h"
#include "marker_layers.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

constexpr int kSides = 6;

/// Half of an arrow's outline, turned round its axis.
struct OutlinePoint {
  double along, radius;
};

std_msgs::ColorRGBA lit(const Vector3& normal, const std_msgs::ColorRGBA& paint) {
  const Rgb light = light_on(normal.cast<float>()).min(1.0f);
  std_msgs::ColorRGBA colour = paint;
  colour.r *= light[0], colour.g *= light[1], colour.b *= light[2];
  return colour;
}

/// Axes across `along`, whichever.
std::array<Vector3, 2> across(const Vector3& along) {
  const Vector3 first = along.unitOrthogonal();
  return {first, along.cross(first)};
}

}  // namespace

Marker& add_arrow(const Arrow& arrow, const std_msgs::ColorRGBA& paint, int id, MarkerLayer& layer) {
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), paint);
  const double length = (arrow.tip - arrow.begin).norm(), neck = length - arrow.head_length;
  const Vector3 along = (arrow.tip - arrow.begin) / length;
  const auto [u, v] = across(along);
  const std::array<OutlinePoint, 5> outline{{{0.0, 0.0},
                                             {0.0, arrow.shaft_radius},
                                             {neck, arrow.shaft_radius},
                                             {neck, arrow.head_radius},
                                             {length, 0.0}}};
  const auto out = [&, x = u, y = v](int side) -> Vector3 {
    const double turn = 2.0 * M_PI * side / kSides;
    return std::cos(turn) * x + std::sin(turn) * y;
  };
  for (std::size_t i = 0; i + 1 < outline.size(); ++i) {
    const OutlinePoint &from = outline[i], &to = outline[i + 1];
    const auto add = [&](const OutlinePoint& point, int side) {
      const Vector3 normal = (to.along - from.along) * out(side) - (to.radius - from.radius) * along;
      const Vector3 place = arrow.begin + point.along * along + point.radius * out(side);
      marker.points.push_back(to_message(place));
      marker.colors.push_back(lit(normal.normalized(), paint));
    };
    for (int side = 0; side < kSides; ++side) {
      if (to.radius > 0.0) add(from, side), add(to, side + 1), add(to, side);
      if (from.radius > 0.0) add(from, side), add(from, side + 1), add(to, to.radius > 0.0 ? side + 1 : side);
    }
  }
  return marker;
}

}  // namespace mrhi
