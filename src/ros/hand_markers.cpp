#include "hand_markers.h"

#include <visualization_msgs/Marker.h>

#include <algorithm>

namespace mrhi {
namespace {

using visualization_msgs::Marker;

constexpr double kUnseen = 0.001;  // a ghost nearer to the hand than this is not drawn [m]
constexpr double kFull = 0.010;    // at this distance its alpha is greatest [m]
constexpr float kGreatestAlpha = 0.5f;
const Rgb kGhost(0.337f, 0.706f, 0.914f);

HandStyle capsule_style() {
  return {color(0.91, 0.76, 0.65), color(0.84, 0.28, 0.06), 1.0};
}
/// Thinner, so that it is hidden in the rendered hand where the two agree.
HandStyle capsule_ghost_style() {
  return {color(0.337, 0.706, 0.914, 0.45), color(0.337, 0.706, 0.914, 0.45), 0.75};
}

double farthest_apart(const Hand& a, const Hand& b) {
  double farthest = 0.0;
  for (std::size_t i = 0; i < kPhalanges; ++i) {
    farthest = std::max(farthest, (a.capsules[i].start - b.capsules[i].start).norm());
    farthest = std::max(farthest, (a.capsules[i].end - b.capsules[i].end).norm());
  }
  return farthest;
}

std_msgs::ColorRGBA to_message(const Rgb& rgb, float alpha) {
  std_msgs::ColorRGBA message;
  message.r = rgb[0], message.g = rgb[1], message.b = rgb[2], message.a = alpha;
  return message;
}

/// Corners in an order that is counter-clockwise from outside for the hand's side.
std::array<std::size_t, 3> corners(const std::array<int, 3>& triangle, Side side) {
  const auto a = static_cast<std::size_t>(triangle[0]), b = static_cast<std::size_t>(triangle[1]),
             c = static_cast<std::size_t>(triangle[2]);
  return side == Side::left ? std::array<std::size_t, 3>{a, c, b} : std::array<std::size_t, 3>{a, b, c};
}

}  // namespace

HandMarkers::HandMarkers() : skin_(Skin::human()), paint_(skin_) {}

void HandMarkers::add(const RenderedHand& rendered, const Hand& tracked, int first_id, HandLayers layers) {
  const bool apart = farthest_apart(rendered.hand, tracked) > kUnseen;
  add_capsules(rendered.hand, rendered.touching, capsule_style(), first_id, layers.capsules);
  if (!skin_.pose(rendered.hand, surface_)) {
    add_capsules(rendered.hand, rendered.touching, capsule_style(), first_id, layers.hand);
    if (apart) add_capsules(tracked, {}, capsule_ghost_style(), first_id, layers.ghost);
    return;
  }
  paint_.paint(rendered.hand, surface_, rendered.touching, colours_);
  add_skin(rendered.hand.side, first_id, layers.hand);
  if (apart) add_ghost(tracked, first_id, layers.ghost);
}

void HandMarkers::add_skin(Side side, int id, MarkerLayer& layer) const {
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), color(1.0, 1.0, 1.0));
  marker.points.reserve(3 * skin_.triangles().size());
  marker.colors.reserve(3 * skin_.triangles().size());
  for (const auto& triangle : skin_.triangles()) {
    for (const std::size_t corner : corners(triangle, side)) {
      marker.points.push_back(mrhi::to_message(surface_.vertices[corner]));
      marker.colors.push_back(to_message(colours_[corner], 1.0f));
    }
  }
}

void HandMarkers::add_ghost(const Hand& tracked, int id, MarkerLayer& layer) {
  if (!skin_.pose(tracked, ghost_)) return;
  alphas_.resize(skin_.size());
  for (std::size_t v = 0; v < skin_.size(); ++v) {
    const double distance = (ghost_.vertices[v] - surface_.vertices[v]).norm();
    const double seen = std::clamp((distance - kUnseen) / (kFull - kUnseen), 0.0, 1.0);
    alphas_[v] = kGreatestAlpha * static_cast<float>(seen);
  }
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), color(1.0, 1.0, 1.0));
  for (const auto& triangle : skin_.triangles()) {
    const auto at = corners(triangle, tracked.side);
    if (alphas_[at[0]] + alphas_[at[1]] + alphas_[at[2]] <= 0.0f) continue;
    for (const std::size_t corner : at) {
      const auto light = static_cast<float>(0.85 + 0.15 * ghost_.normals[corner].z());
      marker.points.push_back(mrhi::to_message(ghost_.vertices[corner]));
      marker.colors.push_back(to_message(light * kGhost, alphas_[corner]));
    }
  }
  if (marker.points.empty()) marker.action = Marker::DELETE;
}

}  // namespace mrhi
