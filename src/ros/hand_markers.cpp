#include <algorithm>
#include <utility>

#include "../math/rotation.h"
#include "../rendering/skin.h"
#include "marker_layers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

constexpr int kSpare = 2 * kMaxHands;  // skin and ghost of each hand

HandStyle capsule_style() {
  return {color(0.91, 0.76, 0.65), color(0.84, 0.28, 0.06), 1.0};
}
/// Thinner, so that it is hidden in the rendered hand where the two coincide.
HandStyle capsule_ghost_style() {
  return {color(0.337, 0.706, 0.914, 0.45), color(0.337, 0.706, 0.914, 0.45), 0.75};
}

std_msgs::ColorRGBA color_message(const Rgb& rgb, float alpha) {
  std_msgs::ColorRGBA message;
  message.r = rgb[0], message.g = rgb[1], message.b = rgb[2], message.a = alpha;
  return message;
}

}  // namespace

double farthest_apart(const Hand& a, const Hand& b) {
  double farthest = 0.0;
  for (std::size_t i = 0; i < kPhalanges; ++i) {
    farthest = std::max(farthest, (a.capsules[i].start - b.capsules[i].start).norm());
    farthest = std::max(farthest, (a.capsules[i].end - b.capsules[i].end).norm());
  }
  return farthest;
}

float ghost_opacity(double distance, const PictureStyle& style) {
  const double seen =
      std::clamp((distance - style.ghost_from) / (style.ghost_full - style.ghost_from), 0.0, 1.0);
  return style.ghost.a * static_cast<float>(seen);
}

Rgb ghost_colour(const Vector3& normal, const PictureStyle& style) {
  const auto light = static_cast<float>(0.85 + 0.15 * normal.z());
  return light * Rgb(style.ghost.r, style.ghost.g, style.ghost.b);
}

HandMarkers::HandMarkers(const Skin& skin) : skin_(skin), outline_(Skin::outline()), paint_(skin_) {}

void HandMarkers::add(const FrameResult& result, const SimulationState& state, const PictureStyle& style,
                      const MarkerLayers& layers) {
  const MarkerLayer hand = layers.layer("hand"), ghost = layers.layer("ghost"),
                    capsules = layers.layer("capsules");
  int first_id = 0;
  for (std::size_t i = 0; i < result.rendered.size(); ++i, first_id += kIdsPerHand) {
    const RenderedHand& rendered = result.rendered[i];
    add_hand(rendered, result.tracked[i], result, state, style, first_id, hand, ghost);
    add_capsules(rendered.hand, rendered.touching, capsule_style(), first_id, capsules);
  }
}

void HandMarkers::add_hand(const RenderedHand& rendered, const Hand& tracked, const FrameResult& result,
                           const SimulationState& state, const PictureStyle& style, int first_id,
                           const MarkerLayer& hand, const MarkerLayer& ghost) {
  const bool apart = farthest_apart(rendered.hand, tracked) > style.ghost_from;
  if (!skin_.pose(rendered.hand, surface_)) {
    add_capsules(rendered.hand, rendered.touching, capsule_style(), first_id, hand);
    if (apart) add_capsules(tracked, {}, capsule_ghost_style(), first_id, ghost);
    return;
  }
  if (!style.skins) return;
  press_flat(result.contacts, state, rendered.hand.id, skin_, surface_);
  add_skin(rendered, first_id, hand);
  if (apart) add_ghost(rendered.hand, tracked, style, first_id, ghost);
}

/// Counter-clockwise from outside for both left and right hands.
void HandMarkers::add_skin(const RenderedHand& rendered, int id, const MarkerLayer& layer) {
  paint_.paint(rendered, surface_, colours_);
  Marker& marker = add_triangles(id, layer);
  marker.points.resize(3 * skin_.triangles().size());
  marker.colors.resize(3 * skin_.triangles().size());
  std::size_t i = 0;
  for (const auto& triangle : skin_.triangles()) {
    for (const std::size_t corner : {0, 1, 2}) {
      const int v = triangle[rendered.hand.side == Side::left ? 2 - corner : corner];
      marker.points[i] = to_message(surface_.vertices[v]);
      marker.colors[i++] = color_message(colours_[v], 1.0f);
    }
  }
}

void HandMarkers::recycle(std::vector<Marker>& markers) {
  for (Marker& marker : markers) {
    if (marker.type == Marker::TRIANGLE_LIST && !marker.colors.empty()) spare_.push_back(std::move(marker));
  }
  const auto smaller = [](const Marker& a, const Marker& b) {
    return a.points.capacity() < b.points.capacity();
  };
  std::sort(spare_.begin(), spare_.end(), smaller);
  if (spare_.size() > kSpare) spare_.erase(spare_.begin(), spare_.end() - kSpare);
}

Marker& HandMarkers::add_triangles(int id, const MarkerLayer& layer) {
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), color(1.0, 1.0, 1.0));
  if (spare_.empty()) return marker;
  marker.points.swap(spare_.back().points);
  marker.colors.swap(spare_.back().colors);
  spare_.pop_back();
  return marker;
}

void HandMarkers::add_ghost(const Hand& rendered, const Hand& tracked, const PictureStyle& style, int id,
                            const MarkerLayer& layer) {
  if (!outline_.pose(tracked, ghost_) || !outline_.pose(rendered, beneath_)) return;
  alphas_.resize(outline_.size());
  for (std::size_t v = 0; v < outline_.size(); ++v)
    alphas_[v] = ghost_opacity((ghost_.vertices[v] - beneath_.vertices[v]).norm(), style);
  Marker& marker = add_triangles(id, layer);
  marker.points.clear();
  marker.colors.clear();
  for (const auto& triangle : outline_.triangles()) {
    const auto alpha = [&](std::size_t i) { return alphas_[triangle[i]]; };
    if (alpha(0) + alpha(1) + alpha(2) <= 0.0f) continue;
    for (const std::size_t corner : {0, 1, 2}) {
      const int v = triangle[tracked.side == Side::left ? 2 - corner : corner];
      marker.points.push_back(to_message(ghost_.vertices[v]));
      marker.colors.push_back(color_message(ghost_colour(ghost_.normals[v], style), alphas_[v]));
    }
  }
  if (marker.points.empty()) marker.action = Marker::DELETE;
}

namespace {

Pose along(const Vector3& start, const Vector3& end) {
  return {0.5 * (start + end), rotation_between(Vector3::UnitZ(), end - start)};
}

void add_bone(const Capsule& bone, bool with_start, const HandStyle& style, const std_msgs::ColorRGBA& skin,
              int id, const MarkerLayer& layer) {
  const double diameter = 2.0 * style.thickness * bone.radius;
  const Vector3 ball = Vector3::Constant(diameter);
  layer.add(id, Marker::SPHERE, {bone.end, Quaternion::Identity()}, ball, skin);
  if (with_start) layer.add(id + 1, Marker::SPHERE, {bone.start, Quaternion::Identity()}, ball, skin);
  const double length = (bone.end - bone.start).norm();
  if (length < 1e-6) return;
  layer.add(id + 2, Marker::CYLINDER, along(bone.start, bone.end), {diameter, diameter, length}, skin);
}

bool follows_another(const Hand& hand, int index) {
  if (bone_of(index) == 0 || !hand.has(index - 1)) return false;
  return (hand.capsules[index].start - hand.capsules[index - 1].end).norm() < 1e-6;
}

}  // namespace

void add_capsules(const Hand& hand, const Touching& touching, const HandStyle& style, int first_id,
                  const MarkerLayer& layer) {
  for (int i = 0; i < kCapsules; ++i) {
    if (!hand.has(i)) continue;
    add_bone(hand.capsules[i], !follows_another(hand, i), style, touching[i] ? style.touching : style.skin,
             first_id + 3 * i, layer);
  }
}

}  // namespace mrhi
