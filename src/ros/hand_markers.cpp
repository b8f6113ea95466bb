#include "hand_markers.h"

#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <utility>

#include "../rendering/light.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

constexpr double kUnseen = 0.003;  // a ghost nearer to the hand than this is not drawn [m]
constexpr double kFull = 0.012;    // at this distance its alpha is greatest [m]
constexpr float kGreatestAlpha = 0.7f;
constexpr std::uint32_t kMiddle = std::numeric_limits<std::uint32_t>::max();
constexpr double kLidDepth = 0.01;     // from the rim on [m]
constexpr int kSpare = 9 * kMaxHands;  // skin, wrist's sides, creases and ghost of each
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

}  // namespace

void add_simulated(const RenderedHand& rendered, int first_id, MarkerLayer& layer) {
  add_capsules(rendered.hand, rendered.touching, capsule_style(), first_id, layer);
}

HandMarkers::HandMarkers(const Skin& skin)
    : skin_(skin),
      outline_(Skin::outline()),
      paint_(skin_),
      creases_(skin_),
      skin_corners_(
          closed(corners_of(skin_, [this](const auto& triangle) { return !fades(triangle); }), rim_)),
      wrist_corners_(corners_of_wrist()),
      outline_corners_(corners_of(outline_, [](const auto&) { return true; })) {}

bool HandMarkers::fades(const std::array<int, 3>& triangle) const {
  const auto faded = [this](int v) { return paint_.opacity(static_cast<std::size_t>(v)) < 1.0f; };
  return std::any_of(triangle.begin(), triangle.end(), faded);
}

int HandMarkers::side_of_wrist(const std::array<int, 3>& triangle) const {
  Vector3 centre = Vector3::Zero();
  for (const int vertex : triangle) centre += skin_.rest()[static_cast<std::size_t>(vertex)] / 3.0;
  const double turns = 0.5 + std::atan2(centre.z(), centre.y()) / (2.0 * M_PI);
  return std::min(kWristSides - 1, static_cast<int>(kWristSides * turns));
}

std::array<HandMarkers::Corners, HandMarkers::kWristSides> HandMarkers::corners_of_wrist() const {
  std::array<Corners, kWristSides> sides;
  for (int side = 0; side < kWristSides; ++side) {
    sides[static_cast<std::size_t>(side)] = corners_of(skin_, [this, side](const auto& triangle) {
      return fades(triangle) && side_of_wrist(triangle) == side;
    });
  }
  return sides;
}

HandMarkers::Corners HandMarkers::corners_of(const Skin& skin, const Chosen& chosen) {
  Corners corners;
  for (const auto& triangle : skin.triangles()) {
    if (!chosen(triangle)) continue;
    for (const std::size_t i : {0, 1, 2}) {
      corners[static_cast<std::size_t>(Side::right)].push_back(static_cast<std::uint32_t>(triangle[i]));
      corners[static_cast<std::size_t>(Side::left)].push_back(static_cast<std::uint32_t>(triangle[2 - i]));
    }
  }
  return corners;
}

/// With the hole closed, which is one loop of edges: who looks through the wrist sees no inside. From its
/// middle: the loop is jagged, and a fan from one of its own corners would stand out between its teeth.
HandMarkers::Corners HandMarkers::closed(Corners corners, std::vector<std::uint32_t>& rim) {
  for (auto& of_side : corners) {
    std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
    for (std::size_t i = 0; i < of_side.size(); ++i) {
      const std::uint32_t a = of_side[i], b = of_side[i % 3 == 2 ? i - 2 : i + 1];
      if (edges.erase({b, a}) == 0) edges.insert({a, b});
    }
    rim.clear();
    for (const auto& [a, b] : edges) {
      of_side.insert(of_side.end(), {kMiddle, b, a});
      rim.push_back(a);
    }
  }
  return corners;
}

void HandMarkers::add(const RenderedHand& rendered, const Hand& tracked, int first_id, HandLayers layers) {
  const bool apart = farthest_apart(rendered.hand, tracked) > kUnseen;
  const auto place = static_cast<std::size_t>(first_id / kIdsPerHand);
  if (drawn_.size() <= place) drawn_.resize(place + 1);
  if (!skin_.pose(rendered.hand, drawn_[place].surface)) {
    add_simulated(rendered, first_id, layers.hand);
    if (apart) add_capsules(tracked, {}, capsule_ghost_style(), first_id, layers.ghost);
    return;
  }
  add_skin(rendered, drawn_[place], first_id, layers.hand);
  if (apart) add_ghost(rendered.hand, tracked, first_id, layers.ghost);
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

void HandMarkers::add_skin(const RenderedHand& rendered, Drawn& drawn, int id, MarkerLayer& layer) {
  const Hand& hand = rendered.hand;
  drawn.new_paint = drawn.colours.empty() || drawn.hand != hand.id || drawn.side != hand.side ||
                    drawn.touching != rendered.touching;
  if (drawn.new_paint) {
    drawn.hand = hand.id, drawn.side = hand.side, drawn.touching = rendered.touching;
    paint(rendered, drawn);
  }
  add_part(drawn, skin_corners_, Vector3::Zero(), id, layer);
  for (const Corners& side : wrist_corners_) {
    Vector3 middle = Vector3::Zero();
    const auto& corners = side[static_cast<std::size_t>(drawn.side)];
    for (const std::uint32_t vertex : corners) middle += drawn.surface.vertices[vertex];
    add_part(drawn, side, middle / static_cast<double>(corners.size()), ++id, layer);
  }
  add_creases(drawn, ++id, layer);
}

std::pair<Vector3, Vector3> HandMarkers::middle_of_rim(const SkinSurface& surface) const {
  Vector3 rim = Vector3::Zero(), all = Vector3::Zero();
  for (const std::uint32_t vertex : rim_) rim += surface.vertices[vertex] / static_cast<double>(rim_.size());
  for (const Vector3& vertex : surface.vertices) all += vertex;
  return {rim, (rim - all / static_cast<double>(surface.vertices.size())).normalized()};
}

/// The lid's middle is in the light that its side of the hand is in: the end of a wrist looks round.
void HandMarkers::paint(const RenderedHand& rendered, Drawn& drawn) const {
  paint_.paint(rendered, drawn.surface, drawn.colours);
  Rgb colour = Rgb::Zero(), light = Rgb::Zero();
  for (const std::uint32_t vertex : rim_) {
    colour += drawn.colours[vertex];
    light += light_on(drawn.surface.normals[vertex].cast<float>());
  }
  const Vector3 outward = middle_of_rim(drawn.surface).second;
  drawn.lid = (colour / light * light_on(outward.cast<float>())).min(1.0f);
}

void HandMarkers::add_part(const Drawn& drawn, const Corners& of_either_side, const Vector3& origin, int id,
                           MarkerLayer& layer) {
  Marker& marker = add_triangles(id, layer);
  marker.pose.position = mrhi::to_message(origin);
  const auto& corners = of_either_side[static_cast<std::size_t>(drawn.side)];
  marker.points.resize(corners.size());
  marker.colors.resize(corners.size());
  // Within the wrist: level with the rim, flat stretches of skin would be above the lid.
  const auto [rim, outward] = middle_of_rim(drawn.surface);
  const Vector3 lid = rim + kLidDepth * outward;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const bool is_middle = corners[i] == kMiddle;
    marker.points[i] = mrhi::to_message((is_middle ? lid : drawn.surface.vertices[corners[i]]) - origin);
    marker.colors[i] = is_middle ? to_message(drawn.lid, 1.0f)
                                 : to_message(drawn.colours[corners[i]], paint_.opacity(corners[i]));
  }
}

void HandMarkers::add_creases(const Drawn& drawn, int id, MarkerLayer& layer) {
  creases_.pose(drawn.surface, drawn.colours, folds_);
  Marker& marker = add_triangles(id, layer);
  marker.points.resize(folds_.size());
  marker.colors.resize(folds_.size());
  for (std::size_t i = 0; i < folds_.size(); ++i) {
    marker.points[i] = mrhi::to_message(folds_[i].place);
    marker.colors[i] = to_message(folds_[i].colour, 1.0f);
  }
}

void HandMarkers::repaint(const std::vector<RenderedHand>& rendered) {
  for (std::size_t i = 0; i < rendered.size() && i < drawn_.size(); ++i) {
    const bool is_drawn = drawn_[i].hand == rendered[i].hand.id && !drawn_[i].colours.empty();
    if (is_drawn && !std::exchange(drawn_[i].new_paint, false)) paint(rendered[i], drawn_[i]);
  }
}

void HandMarkers::add_ghost(const Hand& rendered, const Hand& tracked, int id, MarkerLayer& layer) {
  if (!outline_.pose(tracked, ghost_) || !outline_.pose(rendered, beneath_)) return;
  alphas_.resize(outline_.size());
  for (std::size_t v = 0; v < outline_.size(); ++v) {
    const double distance = (ghost_.vertices[v] - beneath_.vertices[v]).norm();
    const double seen = std::clamp((distance - kUnseen) / (kFull - kUnseen), 0.0, 1.0);
    alphas_[v] = kGreatestAlpha * static_cast<float>(seen);
  }
  Marker& marker = add_triangles(id, layer);
  marker.points.clear();
  marker.colors.clear();
  const auto& corners = outline_corners_[static_cast<std::size_t>(tracked.side)];
  for (std::size_t i = 0; i < corners.size(); i += 3) {
    if (alphas_[corners[i]] + alphas_[corners[i + 1]] + alphas_[corners[i + 2]] <= 0.0f) continue;
    for (std::size_t corner = i; corner < i + 3; ++corner) {
      const std::uint32_t v = corners[corner];
      const auto light = static_cast<float>(0.85 + 0.15 * ghost_.normals[v].z());
      marker.points.push_back(mrhi::to_message(ghost_.vertices[v]));
      marker.colors.push_back(to_message(light * kGhost, alphas_[v]));
    }
  }
  if (marker.points.empty()) marker.action = Marker::DELETE;
}

}  // namespace mrhi
