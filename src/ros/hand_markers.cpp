#include <visualization_msgs/Marker.h>

#include "marker_layers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

constexpr int kIndex = 1, kLittle = 4;
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

  void quad(const std::array<Vector3, 4>& corners, const Vector3& outward) {
    const Vector3 normal = (corners[2] - corners[0]).cross(corners[3] - corners[1]);
    const bool reversed = normal.dot(outward) < 0.0;
    for (const int i : {0, 1, 2, 0, 2, 3}) {
      marker.points.push_back(to_message(corners[static_cast<std::size_t>(reversed ? 3 - i : i)]));
    }
  }

  /// A plate with its middle at the corners; the first two and the last two lie on round bones.
  void plate(const std::array<Vector3, 4>& corners, const Vector3& normal, double half_thickness) {
    const Vector3 up = half_thickness * normal;
    std::array<Vector3, 4> top = corners, bottom = corners;
    for (std::size_t i = 0; i < 4; ++i) top[i] += up, bottom[i] -= up;
    quad(top, normal);
    quad(bottom, -normal);
    const Vector3 middle = 0.25 * (corners[0] + corners[1] + corners[2] + corners[3]);
    for (const auto& [a, b] : {std::pair<std::size_t, std::size_t>{1, 2}, {3, 0}}) {
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

void add_palm(const Hand& hand, const HandStyle& style, const std_msgs::ColorRGBA& skin, int id,
              MarkerLayer& layer) {
  Marker& marker = layer.add(id, Marker::TRIANGLE_LIST, Pose{}, Vector3::Ones(), skin);
  Surface surface{marker};
  const Vector3 normal = hand.palm.orientation * Vector3::UnitZ();
  for (int finger = kIndex; finger < kLittle; ++finger) {
    if (!hand.has(capsule_index(finger, 0)) || !hand.has(capsule_index(finger + 1, 0))) continue;
    const Capsule &a = capsule(hand, finger, 0), &b = capsule(hand, finger + 1, 0);
    const double half = 0.97 * style.thickness * std::min(a.radius, b.radius);
    surface.plate({a.start, a.end, b.end, b.start}, normal, half);
  }
  if (hand.has(capsule_index(0, 1)) && hand.has(capsule_index(kIndex, 0))) {  // the web of the thumb
    const Capsule &thumb = capsule(hand, 0, 1), &index = capsule(hand, kIndex, 0);
    const Vector3 across = (thumb.end - thumb.start).cross(index.end - index.start);
    const double sign = across.dot(normal) < 0.0 ? -1.0 : 1.0;
    const Vector3 web_normal = across.norm() > 1e-9 ? Vector3(sign * across.normalized()) : normal;
    surface.plate({thumb.start, thumb.axis_point(0.9), index.axis_point(0.75), index.start}, web_normal,
                  0.8 * style.thickness * index.radius);
  }
  if (marker.points.empty()) marker.action = Marker::DELETE;
}

}  // namespace

void add_hand(const Hand& hand, const std::array<bool, kCapsules>& touching, const HandStyle& style,
              int first_id, MarkerLayer& layer) {
  for (int i = 0; i < kPhalanges; ++i) {
    if (!hand.has(i)) continue;
    const auto index = static_cast<std::size_t>(i);
    add_bone(hand.capsules[index], !follows_another(hand, i), style,
             touching[index] ? style.touching : style.skin, first_id + 3 * i, layer);
  }
  add_palm(hand, style, touching[kPalm] ? style.touching : style.skin, first_id + kPalmId, layer);
}

}  // namespace mrhi
