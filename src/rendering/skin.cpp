#include "skin.h"

#include <algorithm>
#include <cstring>

#include "generated_skin.h"
#include "mr_hand_interaction/synthetic/hand_skeleton.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {
namespace {

constexpr double kFacets = 60.0;  // of the triangles' normals, about as much as the bones'

/// Columns that map an influence's place on its bone to world.
struct Carrier {
  Vector3 start, along;
  Matrix3 beyond, axes;
};

Carrier carrier(const SkinBone& bone) {
  return {bone.start, bone.length * bone.axes.col(0), bone.radius * bone.axes, bone.axes};
}

/// One after the other.
std::array<Skin, 3> read_skins() {
  const char* at = shipped_skins().data();
  const auto read = [&at](void* to, std::size_t bytes) {
    std::memcpy(to, at, bytes);
    at += bytes;
  };
  const auto skin = [&read] {
    SkinModel model;
    SkinModel::visit_parts(model, [&read](auto& part) {
      std::uint32_t count = 0;
      read(&count, sizeof count);
      part.resize(count);
      read(part.data(), count * sizeof part[0]);
    });
    return Skin(std::move(model));
  };
  return {skin(), skin(), skin()};
}

const std::array<Skin, 3>& skins() {
  static const std::array<Skin, 3> all = read_skins();
  return all;
}

}  // namespace

std::string_view shipped_skins() {
  static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "rest_skin.bin is written so");
  return {reinterpret_cast<const char*>(kSkinBytes), sizeof kSkinBytes};
}

/// The cross product of two sides is twice the area along the normal; summed, large triangles count for more.
/// A left hand's triangles run clockwise, and the sign is turned.
void add_facets(const std::vector<std::array<int, 3>>& triangles, const Hand& hand,
                const std::vector<Vector3>& vertices, std::vector<Vector3>& normals) {
  const double per_area =
      (hand.side == Side::left ? -kFacets : kFacets) / (hand.palm_width * hand.palm_width);
  for (const auto& triangle : triangles) {
    const auto a = static_cast<std::size_t>(triangle[0]), b = static_cast<std::size_t>(triangle[1]),
               c = static_cast<std::size_t>(triangle[2]);
    const Vector3& corner = vertices[a];
    const Vector3 area = per_area * (vertices[b] - corner).cross(vertices[c] - corner);
    normals[a] += area;
    normals[b] += area;
    normals[c] += area;
  }
}

const Skin& Skin::detailed() {
  return skins()[0];
}

const Skin& Skin::human() {
  return skins()[1];
}

const Skin& Skin::outline() {
  return skins()[2];
}

/// Linear blend skinning (Magnenat-Thalmann, Laperriere & Thalmann 1988):
///     x = sum_b w_b (start_b + along length_b x_b + radius_b A_b beyond),   A_b the bone's axes in world.
/// It thins a joint that bends far, as a mean of two turns does: so there are bones half-way, the bends.
bool Skin::pose(const Hand& hand, SkinSurface& surface) const {
  if (!has_whole_skin(hand)) return false;
  const SkinRig rig = pose_rig(hand);
  std::array<Carrier, kSkinBones> carriers;
  std::transform(rig.begin(), rig.end(), carriers.begin(), carrier);
  surface.vertices.resize(size());
  surface.normals.resize(size());
  std::size_t i = 0;
  for (std::size_t v = 0; v < size(); ++v) {
    Vector3 place = Vector3::Zero(), normal = Vector3::Zero();
    for (; i < model_.ends[v]; ++i) {
      const SkinModel::Influence& influence = model_.influences[i];
      const Carrier& c = carriers[static_cast<std::size_t>(influence.bone)];
      place += influence.weight *
               (c.start + influence.along * c.along + c.beyond * influence.beyond.cast<double>());
      normal += c.axes * influence.normal.cast<double>();
    }
    surface.vertices[v] = place;
    surface.normals[v] = normal;
  }
  add_facets(model_.triangles, hand, surface.vertices, surface.normals);
  for (Vector3& normal : surface.normals) normal.normalize();
  return true;
}

namespace {

constexpr double kDegree = M_PI / 180.0;

HandPosture rest_posture() {
  HandPosture posture = HandPosture::Zero();
  posture.row(kAbduction) << 0.0, 6.0, 1.0, -5.0, -10.0;
  return kDegree * posture;
}

/// z is as near to `back` as x allows. y = back x x, z = x x y: what is left of `back` across x.
Matrix3 axes_along(const Vector3& x, const Vector3& back) {
  Matrix3 axes;
  axes.col(0) = x.normalized();
  axes.col(1) = back.cross(axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

SkinBone bone_along(const Capsule& capsule, const Matrix3& axes) {
  return {capsule.start, axes, (capsule.end - capsule.start).norm(), capsule.radius};
}

RestHand make_rest_hand() {
  RestHand rest;
  rest.hand = complete_hand(hand_joints(human_hand(), Side::right, Pose{}, rest_posture()), Pose{});
  for (int finger = 0; finger < kFingers; ++finger) {
    const Vector3 back = human_hand().fingers[static_cast<std::size_t>(finger)].root.col(2);
    for (int bone = first_bone(finger); bone < kBonesPerFinger; ++bone) {
      const auto index = static_cast<std::size_t>(capsule_index(finger, bone));
      const Capsule& capsule = rest.hand.capsules[index];
      rest.rig[index] =
          bone_along(capsule, axes_along(capsule.end - capsule.start, bone == 0 ? Vector3::UnitZ() : back));
      if (bone > 0) rest.rig[static_cast<std::size_t>(bend_index(finger, bone))] = rest.rig[index];
    }
  }
  rest.rig[kWristBone] = {rest.hand.wrist, rest.hand.palm.orientation.toRotationMatrix(),
                          rest.hand.palm_width, rest.hand.palm_width};
  return rest;
}

/// The rest hand's axes for a hand of this side. M A M with M = diag(1, -1, 1): mirrored and mirrored back it
/// is a rotation again.
Matrix3 mirrored(Matrix3 axes, Side side) {
  if (side == Side::left) axes.row(1) *= -1.0, axes.col(1) *= -1.0;
  return axes;
}

class Poser {
 public:
  explicit Poser(const Hand& hand) : hand_(hand), rest_(rest_hand().rig) {
    rig_[kWristBone] = {hand.wrist, hand.palm.orientation.toRotationMatrix(), hand.palm_width,
                        hand.palm_width};
  }

  SkinRig pose() {
    for (int finger = 0; finger < kFingers; ++finger) {
      int parent = kWristBone;
      for (int bone = first_bone(finger); bone < kBonesPerFinger; ++bone) {
        const int index = capsule_index(finger, bone);
        turn(index, parent, bone > 0 ? bend_index(finger, bone) : -1);
        parent = index;
      }
    }
    if (hand_.side == Side::left) {
      for (SkinBone& bone : rig_) bone.axes.col(1) *= -1.0;
    }
    return rig_;
  }

 private:
  Matrix3 rest_axes(int index) const {
    return mirrored(rest_[static_cast<std::size_t>(index)].axes, hand_.side);
  }

  /// From the parent as it is now, by the turn that the rest hand has between the two, then by the least
  /// rotation that brings x onto the bone: no twist about the bone, which the tracker does not tell. The bend
  /// has half of that rotation. Folded back by 180 degrees the least rotation is not unique; no joint goes so
  /// far.
  void turn(int index, int parent, int bend) {
    const auto i = static_cast<std::size_t>(index);
    const Capsule& capsule = hand_.capsules[i];
    const Matrix3 unbent =
        rig_[static_cast<std::size_t>(parent)].axes * rest_axes(parent).transpose() * rest_axes(index);
    const Quaternion turned = Quaternion::FromTwoVectors(unbent.col(0), capsule.end - capsule.start);
    rig_[i] = bone_along(capsule, turned * unbent);
    if (bend < 0) return;
    SkinBone& half = rig_[static_cast<std::size_t>(bend)];
    half = rig_[i];
    half.axes = Quaternion::Identity().slerp(0.5, turned) * unbent;
  }

  const Hand& hand_;
  const SkinRig& rest_;
  SkinRig rig_;
};

}  // namespace

const RestHand& rest_hand() {
  static const RestHand rest = make_rest_hand();
  return rest;
}

bool has_whole_skin(const Hand& hand) {
  for (int i = 0; i < kPhalanges; ++i) {
    if (i != capsule_index(0, 0) && !hand.has(i)) return false;
  }
  return hand.palm_width > 0.0;
}

SkinRig pose_rig(const Hand& hand) {
  return Poser(hand).pose();
}

}  // namespace mrhi
