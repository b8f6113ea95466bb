#include "skin.h"

#include <cmath>
#include <cstring>

#include "../math/rotation.h"
#include "generated_skin.h"
#include "mr_hand_interaction/tracking/hand_skeleton.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {
namespace {

/// Weight of the triangles' normals, about that of the bones'.
constexpr double kFacetWeight = 60.0;

/// Reads the three skins in their order in the file.
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

SkinBone wrist_bone(const Hand& hand) {
  return {hand.wrist, hand.palm.orientation.toRotationMatrix(), hand.palm_width, hand.palm_width};
}

RestHand make_rest_hand() {
  const HandPosture spread = posture_of_degrees({{0.0, 6.0, 1.0, -5.0, -10.0}});
  RestHand rest;
  rest.hand = complete_hand(hand_joints(human_hand(), Side::right, Pose{}, spread), Pose{});
  for (int finger = 0; finger < kFingers; ++finger) {
    const Vector3 back = human_hand().fingers[finger].root.col(2);
    for (int bone = first_bone(finger); bone < kBonesPerFinger; ++bone) {
      const int index = capsule_index(finger, bone);
      const Capsule& capsule = rest.hand.capsules[index];
      rest.rig[index] =
          bone_along(capsule, axes_along(capsule.end - capsule.start, bone == 0 ? Vector3::UnitZ() : back));
      if (bone > 0) rest.rig[bend_index(finger, bone)] = rest.rig[index];
    }
  }
  rest.rig[kWristBone] = wrist_bone(rest.hand);
  return rest;
}

/// The rest hand's axes for a hand of this side. M A M with M = diag(1, -1, 1): mirrored and mirrored back it
/// is a rotation again.
Matrix3 mirrored(Matrix3 axes, Side side) {
  if (side == Side::left) axes.row(1) *= -1.0, axes.col(1) *= -1.0;
  return axes;
}

/// Radii of the red spot of a contact and of its core, in radii of the phalanx.
constexpr double kSpotRadius = 2.0, kSpotCoreRadius = 1.1;
/// Redness without force, and the force of full redness [N].
constexpr double kMinRedness = 0.8, kFullRednessForce = 6.0;
/// Factor on the occluded light, and the smallest fraction of ambient light that arrives.
constexpr float kOcclusion = 0.7f, kMinAmbient = 0.4f;

/// Number of occluding spheres: one for each phalanx, as large as it appears from the side, padded to a
/// multiple of the vector width.
constexpr int kSpheres = 16;
using Floats = Eigen::Array<float, kSpheres, 1>;

constexpr int sphere_of(int finger, int bone) {
  return finger * (kBonesPerFinger - 1) + bone - 1;
}

/// Seen from its side a capsule is 2 r l + pi r^2 large, as is a disc of R^2 = 2 r l / pi + r^2.
struct Occluders {
  Floats x = Floats::Zero(), y = Floats::Zero(), z = Floats::Zero(), squared = Floats::Zero();

  explicit Occluders(const Hand& hand) {
    for (int f = 0; f < kFingers; ++f) {
      for (int b = 1; b < kBonesPerFinger; ++b) {
        const Capsule& capsule = hand.capsules[capsule_index(f, b)];
        const Vector3 centre = capsule.centre();
        const double length = (capsule.end - capsule.start).norm(), r = capsule.radius;
        const int i = sphere_of(f, b);
        x[i] = static_cast<float>(centre.x());
        y[i] = static_cast<float>(centre.y());
        z[i] = static_cast<float>(centre.z());
        squared[i] = static_cast<float>(2.0 / M_PI * r * length + r * r);
      }
    }
  }

  /// Fraction of ambient light that arrives; `counts` is 0 for spheres that do not occlude this place. A
  /// sphere of radius R at the distance d takes (n.d / |d|) (R / |d|)^2 of the light that comes evenly from
  /// the half space of n, while it is above the horizon; several are summed, as if none covered another. 1e-6
  /// m^2 keeps one about the place itself from dividing by 0.
  float left(const Eigen::Vector3f& p, const Eigen::Vector3f& n, const Floats& counts) const {
    const Floats dx = x - p.x(), dy = y - p.y(), dz = z - p.z();
    const Floats d = dx * dx + dy * dy + dz * dz + 1e-6f;
    const Floats facing = (dx * n.x() + dy * n.y() + dz * n.z()).max(0.0f);
    return std::max(kMinAmbient, 1.0f - kOcclusion * (counts * squared * facing / (d * d.sqrt())).sum());
  }
};

bool is_palm(int capsule) {
  return capsule == kPalm || bone_of(capsule) == 0;
}

bool same_part(int a, int b) {
  return is_palm(a) ? is_palm(b) : !is_palm(b) && finger_of(a) == finger_of(b);
}

/// A phalanx is not covered by itself and its neighbours, nor the palm by what grows out of it.
std::array<Floats, kCapsules> make_counts() {
  std::array<Floats, kCapsules> counts;
  for (int own = 0; own < kCapsules; ++own) {
    Floats& row = counts[own];
    row.setZero();
    for (int f = 0; f < kFingers; ++f) {
      for (int b = 1; b < kBonesPerFinger; ++b) {
        const bool near = is_palm(own) ? b == 1 : finger_of(own) == f && std::abs(bone_of(own) - b) <= 1;
        row[sphere_of(f, b)] = near ? 0.0f : 1.0f;
      }
    }
  }
  return counts;
}

/// Force at which 63 % of the deepest compression is reached [N].
constexpr double kCompressionForce = 2.0;
/// Radius around the contact in which skin is flattened, in radii of the phalanx.
constexpr double kFlattenedRadius = 1.3;

/// Height h over the plane becomes 0 up to the depth d, h from 3 d on, and 3/2 (h - d) between.
double flattened(double height, double depth) {
  if (height >= 3.0 * depth) return height;
  return std::max(0.0, 1.5 * (height - depth));
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
      (hand.side == Side::left ? -kFacetWeight : kFacetWeight) / (hand.palm_width * hand.palm_width);
  for (const auto& [a, b, c] : triangles) {
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
  struct Carrier {  // maps an influence's place on its bone to world
    Vector3 start, along;
    Matrix3 beyond, axes;
  };
  std::array<Carrier, kSkinBones> carriers;
  std::transform(rig.begin(), rig.end(), carriers.begin(), [](const SkinBone& bone) {
    return Carrier{bone.start, bone.length * bone.axes.col(0), bone.radius * bone.axes, bone.axes};
  });
  surface.vertices.resize(size());
  surface.normals.resize(size());
  std::size_t i = 0;
  for (std::size_t v = 0; v < size(); ++v) {
    Vector3 place = Vector3::Zero(), normal = Vector3::Zero();
    for (; i < model_.ends[v]; ++i) {
      const SkinModel::Influence& influence = model_.influences[i];
      const Carrier& c = carriers[influence.bone];
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

/// Trackers do not report a twist of a bone about itself: each turns with its parent as in the rest hand,
/// then by the smallest rotation that brings x onto the bone. The bend between both has half of that
/// rotation. At 180 degrees the smallest rotation would not be unique; no joint bends that far.
SkinRig pose_rig(const Hand& hand) {
  const auto rest_axes = [&](int bone) { return mirrored(rest_hand().rig[bone].axes, hand.side); };
  SkinRig rig;
  rig[kWristBone] = wrist_bone(hand);
  for (int finger = 0; finger < kFingers; ++finger) {
    int parent = kWristBone;
    for (int bone = first_bone(finger); bone < kBonesPerFinger; ++bone) {
      const int index = capsule_index(finger, bone);
      const Capsule& capsule = hand.capsules[index];
      const Matrix3 unbent = rig[parent].axes * rest_axes(parent).transpose() * rest_axes(index);
      const Quaternion turned = rotation_between(unbent.col(0), capsule.end - capsule.start);
      rig[index] = bone_along(capsule, turned * unbent);
      parent = index;
      if (bone == 0) continue;
      SkinBone& half = rig[bend_index(finger, bone)];
      half = rig[index];
      half.axes = Quaternion::Identity().slerp(0.5, turned) * unbent;
    }
  }
  if (hand.side == Side::left)
    for (SkinBone& bone : rig) bone.axes.col(1) *= -1.0;
  return rig;
}

void paint_skin(const Skin& skin, const RenderedHand& rendered, const SkinSurface& surface,
                std::vector<Rgb>& colours, const SkinTone& tone) {
  static const std::array<Floats, kCapsules> counts = make_counts();
  const Occluders occluders(rendered.hand);
  std::vector<int> touched;
  for (int c = 0; c < kCapsules; ++c)
    if (rendered.touching[c]) touched.push_back(c);
  // Fraction of the touching colour, from the contacts of the vertex's own finger or of the palm.
  const auto redness = [&](const Vector3& place, int own) {
    double red = 0.0;
    for (const int c : touched) {
      if (!same_part(c, own)) continue;
      const double radius = rendered.hand.capsules[c].radius;
      const double away = (place - rendered.pressed[c].point).norm();
      const double firm =
          kMinRedness + (1.0 - kMinRedness) * std::min(1.0, rendered.pressed[c].force / kFullRednessForce);
      red = std::max(red, firm * smooth_step(kSpotRadius * radius, kSpotCoreRadius * radius, away));
    }
    return static_cast<float>(red);
  };
  colours.resize(surface.vertices.size());
  for (std::size_t v = 0; v < colours.size(); ++v) {
    const SkinModel::Look& look = skin.model().looks[v];
    const float red = redness(surface.vertices[v], look.capsule);
    const Rgb paint = tone.skin * look.colour;
    const Rgb colour = paint + red * (tone.touching - paint);
    const Eigen::Vector3f normal = surface.normals[v].cast<float>();
    const float around = occluders.left(surface.vertices[v].cast<float>(), normal, counts[look.capsule]);
    colours[v] = (colour * light_on(normal, around)).min(1.0f);
  }
}

void flatten_pads(const std::vector<Contact>& contacts, const SimulationState& state, std::uint32_t hand,
                  const Skin& skin, SkinSurface& surface) {
  for (const Contact& contact : contacts) {
    if (!contact.touching() || state.hands[contact.key.hand].current.id != hand) continue;
    const double force = std::abs(contact.normal.dot(contact.force));
    const double depth = kMaxPadCompression * (1.0 - std::exp(-force / kCompressionForce));
    const double around = kFlattenedRadius * contact.radius;
    for (std::size_t v = 0; v < skin.size(); ++v) {
      if (!same_part(contact.key.capsule, skin.model().looks[v].capsule)) continue;
      const Vector3 out = surface.vertices[v] - contact.point;
      const double height = contact.normal.dot(out);
      const bool near = height < 3.0 * depth && height > -depth && out.squaredNorm() < around * around;
      if (near) surface.vertices[v] += (flattened(height, depth) - height) * contact.normal;
    }
  }
}

}  // namespace mrhi
