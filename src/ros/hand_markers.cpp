#include <algorithm>

#include "../math/rotation.h"
#include "marker_layers.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

const HandStyle kHandStyle{color(0.91, 0.76, 0.65), color(0.84, 0.28, 0.06), 1.0};
/// Thinner, so that it is hidden in the rendered hand where the two coincide.
const HandStyle kGhostStyle{color(0.337, 0.706, 0.914, 0.45), color(0.337, 0.706, 0.914, 0.45), 0.75};

}  // namespace

float ghost_opacity(double distance, const PictureStyle& style) {
  const double seen =
      std::clamp((distance - style.ghost_from) / (style.ghost_full - style.ghost_from), 0.0, 1.0);
  return style.ghost.a * static_cast<float>(seen);
}

Rgb ghost_colour(const Vector3& normal, const PictureStyle& style) {
  const auto light = static_cast<float>(0.85 + 0.15 * normal.z());
  return light * Rgb(style.ghost.r, style.ghost.g, style.ghost.b);
}

void HandMarkers::add(const FrameResult& result, const SimulationState& state, const PictureStyle& style,
                      const MarkerLayers& layers) {
  const MarkerLayer hand = layers.layer("hand"), ghost = layers.layer("ghost"),
                    capsules = layers.layer("capsules");
  int id = 0;
  for (std::size_t i = 0; i < result.rendered.size(); ++i, id += kIdsPerHand) {
    const RenderedHand& rendered = result.rendered[i];
    const Hand& tracked = result.tracked[i];
    const bool apart = farthest_joint(rendered.hand, tracked) > style.ghost_from;
    if (!skin_.pose(rendered.hand, surface_)) {
      add_capsules(rendered.hand, rendered.touching, kHandStyle, id, hand);
      if (apart) add_capsules(tracked, {}, kGhostStyle, id, ghost);
    } else if (style.skins) {
      press_flat(result.contacts, state, rendered.hand.id, skin_, surface_);
      paint_skin(skin_, rendered, surface_, colours_);
      alphas_.assign(skin_.size(), 1.0f);
      add_skin(skin_, rendered.hand.side, id, hand);
      if (apart && pose_ghost(rendered.hand, tracked, style)) add_skin(outline_, tracked.side, id, ghost);
    }
    add_capsules(rendered.hand, rendered.touching, kHandStyle, id, capsules);
  }
}

bool HandMarkers::pose_ghost(const Hand& rendered, const Hand& tracked, const PictureStyle& style) {
  if (!outline_.pose(tracked, surface_) || !outline_.pose(rendered, beneath_)) return false;
  alphas_.resize(outline_.size());
  colours_.resize(outline_.size());
  for (std::size_t v = 0; v < outline_.size(); ++v) {
    alphas_[v] = ghost_opacity((surface_.vertices[v] - beneath_.vertices[v]).norm(), style);
    colours_[v] = ghost_colour(surface_.normals[v], style);
  }
  return true;
}

void HandMarkers::recycle(std::vector<Marker>& markers) {
  spare_.clear();
  for (Marker& marker : markers)
    if (marker.ns == "hand" || marker.ns == "ghost") spare_.push_back(std::move(marker));
}

/// Adds the visible triangles of the surface, counter-clockwise from outside for both left and right hands.
void HandMarkers::add_skin(const Skin& skin, Side side, int id, const MarkerLayer& layer) {
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), color(1.0, 1.0, 1.0));
  const auto spare =
      std::find_if(spare_.begin(), spare_.end(), [&](const Marker& used) { return used.ns == marker.ns; });
  if (spare != spare_.end()) {
    marker.points.swap(spare->points);
    marker.colors.swap(spare->colors);
    spare_.erase(spare);
  }
  marker.points.clear();
  marker.colors.clear();
  marker.points.reserve(3 * skin.triangles().size());
  marker.colors.reserve(3 * skin.triangles().size());
  for (const auto& triangle : skin.triangles()) {
    if (alphas_[triangle[0]] + alphas_[triangle[1]] + alphas_[triangle[2]] <= 0.0f) continue;
    for (const std::size_t corner : {0, 1, 2}) {
      const int v = triangle[side == Side::left ? 2 - corner : corner];
      std_msgs::ColorRGBA& paint = marker.colors.emplace_back();
      paint.r = colours_[v][0], paint.g = colours_[v][1], paint.b = colours_[v][2], paint.a = alphas_[v];
      marker.points.push_back(to_message(surface_.vertices[v]));
    }
  }
  if (marker.points.empty()) marker.action = Marker::DELETE;
}

namespace {

void add_bone(const Capsule& bone, bool with_start, const HandStyle& style, const std_msgs::ColorRGBA& skin,
              int id, const MarkerLayer& layer) {
  const double diameter = 2.0 * style.thickness * bone.radius;
  const Vector3 ball = Vector3::Constant(diameter);
  layer.add(id, Marker::SPHERE, {bone.end}, ball, skin);
  if (with_start) layer.add(id + 1, Marker::SPHERE, {bone.start}, ball, skin);
  const double length = (bone.end - bone.start).norm();
  if (length < 1e-6) return;
  layer.add(id + 2, Marker::CYLINDER,
            {bone.centre(), rotation_between(Vector3::UnitZ(), bone.end - bone.start)},
            {diameter, diameter, length}, skin);
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
