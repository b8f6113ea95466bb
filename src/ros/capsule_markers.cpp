#include <visualization_msgs/Marker.h>

#include <algorithm>

#include "marker_layers.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

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
