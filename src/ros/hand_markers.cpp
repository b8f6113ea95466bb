#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "../rendering/skin.h"
#include "marker_layers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

constexpr int kSpare = 8 * kMaxHands;  // skin, wrist's sides and ghost of each

HandStyle capsule_style() {
  return {color(0.91, 0.76, 0.65), color(0.84, 0.28, 0.06), 1.0};
}
/// Thinner, so that it is hidden in the rendered hand where the two agree.
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

void add_simulated(const RenderedHand& rendered, int first_id, MarkerLayer& layer) {
  add_capsules(rendered.hand, rendered.touching, capsule_style(), first_id, layer);
}

HandMarkers::HandMarkers(const Skin& skin)
    : skin_(skin), outline_(Skin::outline()), paint_(skin_), wrist_(skin_) {
  for (const auto& triangle : wrist_.fading()) sides_[side_of_wrist(triangle)].push_back(triangle);
}

std::size_t HandMarkers::side_of_wrist(const SkinWrist::Triangle& triangle) const {
  Vector3 centre = Vector3::Zero();
  for (const std::uint32_t vertex : triangle) centre += skin_.rest()[vertex] / 3.0;
  const double turns = 0.5 + std::atan2(centre.z(), centre.y()) / (2.0 * M_PI);
  return static_cast<std::size_t>(std::min(kWristSides - 1, static_cast<int>(kWristSides * turns)));
}

void HandMarkers::add(const RenderedHand& rendered, const Hand& tracked, const FrameResult& result,
                      const SimulationState& state, const PictureStyle& style, int first_id,
                      HandLayers layers) {
  const bool apart = farthest_apart(rendered.hand, tracked) > style.ghost_from;
  if (!skin_.pose(rendered.hand, surface_)) {
    add_simulated(rendered, first_id, layers.hand);
    if (apart) add_capsules(tracked, {}, capsule_ghost_style(), first_id, layers.ghost);
    return;
  }
  if (!style.skins) return;
  press_flat(result.contacts, state, rendered.hand.id, skin_, surface_);
  add_skin(rendered, first_id, layers.hand);
  if (apart) add_ghost(rendered.hand, tracked, style, first_id, layers.ghost);
}

void HandMarkers::add_skin(const RenderedHand& rendered, int first_id, MarkerLayer& layer) {
  paint_.paint(rendered, surface_, colours_);
  wrist_.add_lid(surface_, colours_);
  const Side side = rendered.hand.side;
  add_part(wrist_.opaque(), side, Vector3::Zero(), first_id, layer);
  for (const Triangles& triangles : sides_) {
    Vector3 middle = Vector3::Zero();
    for (const auto& triangle : triangles)
      for (const std::uint32_t v : triangle)
        middle += surface_.vertices[v] / (3.0 * static_cast<double>(triangles.size()));
    add_part(triangles, side, middle, ++first_id, layer);
  }
}

/// Counter-clockwise from outside for either side.
void HandMarkers::add_part(const Triangles& triangles, Side side, const Vector3& origin, int id,
                           MarkerLayer& layer) {
  Marker& marker = add_triangles(id, layer);
  marker.pose.position = to_message(origin);
  marker.points.resize(3 * triangles.size());
  marker.colors.resize(3 * triangles.size());
  std::size_t i = 0;
  for (const auto& triangle : triangles) {
    for (const std::size_t corner : {0, 1, 2}) {
      const std::uint32_t v = triangle[side == Side::left ? 2 - corner : corner];
      marker.points[i] = to_message(Vector3(surface_.vertices[v] - origin));
      marker.colors[i++] = color_message(colours_[v], wrist_.opacity(v));
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

Marker& HandMarkers::add_triangles(int id, MarkerLayer& layer) {
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), color(1.0, 1.0, 1.0));
  if (spare_.empty()) return marker;
  marker.points.swap(spare_.back().points);
  marker.colors.swap(spare_.back().colors);
  spare_.pop_back();
  return marker;
}

void HandMarkers::add_ghost(const Hand& rendered, const Hand& tracked, const PictureStyle& style, int id,
                            MarkerLayer& layer) {
  if (!outline_.pose(tracked, ghost_) || !outline_.pose(rendered, beneath_)) return;
  alphas_.resize(outline_.size());
  for (std::size_t v = 0; v < outline_.size(); ++v)
    alphas_[v] = ghost_opacity((ghost_.vertices[v] - beneath_.vertices[v]).norm(), style);
  Marker& marker = add_triangles(id, layer);
  marker.points.clear();
  marker.colors.clear();
  for (const auto& triangle : outline_.triangles()) {
    const auto alpha = [&](std::size_t i) { return alphas_[static_cast<std::size_t>(triangle[i])]; };
    if (alpha(0) + alpha(1) + alpha(2) <= 0.0f) continue;
    for (const std::size_t corner : {0, 1, 2}) {
      const auto v = static_cast<std::size_t>(triangle[tracked.side == Side::left ? 2 - corner : corner]);
      marker.points.push_back(to_message(ghost_.vertices[v]));
      marker.colors.push_back(color_message(ghost_colour(ghost_.normals[v], style), alphas_[v]));
    }
  }
  if (marker.points.empty()) marker.action = Marker::DELETE;
}

namespace {

constexpr int kIndex = 1, kLittle = 4;
constexpr double kPlate = 1.02;  // of the metacarpals' radius: not level with their cylinders
constexpr int kPalmId = 3 * kPhalanges;

const Capsule& capsule(const Hand& hand, int finger, int bone) {
  return hand.capsules[static_cast<std::size_t>(capsule_index(finger, bone))];
}

Pose along(const Vector3& start, const Vector3& end) {
  return {0.5 * (start + end), Quaternion::FromTwoVectors(Vector3::UnitZ(), end - start)};
}

/// Triangles of one marker.
struct Surface {
  Marker& marker;
  double spread;  ///< of a plate about its middle; below 1, it lies inside a plate of 1

  void quad(const std::array<Vector3, 4>& corners, const Vector3& outward) {
    const Vector3 normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]);
    const bool reversed = normal.dot(outward) < 0.0;
    for (const int i : {0, 1, 2, 0, 2, 3}) {
      marker.points.push_back(to_message(corners[static_cast<std::size_t>(reversed ? 3 - i : i)]));
    }
  }

  /// A plate with its middle at the corners.
  void plate(std::array<Vector3, 4> corners, const Vector3& normal, double half_thickness) {
    const Vector3 middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    for (Vector3& corner : corners) corner = middle + spread * (corner - middle);
    const Vector3 up = half_thickness * normal;
    std::array<Vector3, 4> top = corners, bottom = corners;
    for (std::size_t i = 0; i < 4; ++i) top[i] += up, bottom[i] -= up;
    quad(top, normal);
    quad(bottom, -normal);
    for (std::size_t a = 0; a < 4; ++a) {
      const std::size_t b = (a + 1) % 4;
      if (corners[a] == corners[b]) continue;
      quad({top[a], top[b], bottom[b], bottom[a]}, 0.5 * (corners[a] + corners[b]) - middle);
    }
  }
};

void add_bone(const Capsule& bone, bool with_start, const HandStyle& style, const std_msgs::ColorRGBA& skin,
              int id, MarkerLayer& layer) {
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
  const auto i = static_cast<std::size_t>(index);
  return (hand.capsules[i].start - hand.capsules[i - 1].end).norm() < 1e-6;
}

/// The plates of a palm: between the metacarpals, the web of the thumb, and the wrist.
class Palm {
 public:
  Palm(const Hand& hand, double thickness, Marker& marker)
      : hand_(hand),
        thickness_(thickness),
        surface_{marker, thickness},
        normal_(hand.palm.orientation * Vector3::UnitZ()) {}

  void between_metacarpals() {
    for (int finger = kIndex; finger < kLittle; ++finger) {
      if (!has(finger) || !has(finger + 1)) continue;
      const Capsule &a = capsule(hand_, finger, 0), &b = capsule(hand_, finger + 1, 0);
      surface_.plate({a.start, a.end, b.end, b.start}, normal_, half(a, b));
      surface_.plate({hand_.wrist, a.start, b.start, hand_.wrist}, normal_, half(a, b));
    }
  }

  void thumb() {
    if (!hand_.has(capsule_index(0, 1)) || !has(kIndex)) return;
    const Capsule &thumb = capsule(hand_, 0, 1), &index = capsule(hand_, kIndex, 0);
    Vector3 across = (thumb.end - thumb.start).cross(index.end - index.start);
    if (across.dot(normal_) < 0.0) across = -across;
    const Vector3 normal = across.norm() > 1e-9 ? across.normalized() : normal_;
    surface_.plate({thumb.start, thumb.axis_point(0.9), index.axis_point(0.75), index.start}, normal,
                   0.8 * half(thumb, index));
    surface_.plate({hand_.wrist, thumb.start, index.start, hand_.wrist}, normal_, half(thumb, index));
  }

 private:
  bool has(int finger) const { return hand_.has(capsule_index(finger, 0)); }
  double half(const Capsule& a, const Capsule& b) const {
    return kPlate * thickness_ * std::min(a.radius, b.radius);
  }

  const Hand& hand_;
  double thickness_;
  Surface surface_;
  Vector3 normal_;
};

void add_palm(const Hand& hand, const HandStyle& style, const std_msgs::ColorRGBA& skin, int id,
              MarkerLayer& layer) {
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), skin);
  Palm palm(hand, style.thickness, marker);
  palm.between_metacarpals();
  palm.thumb();
  if (marker.points.empty()) marker.action = Marker::DELETE;
}

}  // namespace

void add_capsules(const Hand& hand, const Touching& touching, const HandStyle& style, int first_id,
                  MarkerLayer& layer) {
  for (int i = 0; i < kPhalanges; ++i) {
    if (!hand.has(i)) continue;
    const auto index = static_cast<std::size_t>(i);
    add_bone(hand.capsules[index], !follows_another(hand, i), style,
             touching[index] ? style.touching : style.skin, first_id + 3 * i, layer);
  }
  add_palm(hand, style, touching[kPalm] ? style.touching : style.skin, first_id + kPalmId, layer);
}

}  // namespace mrhi
