#include "skin.h"

#include <algorithm>
#include <cstring>

#include "generated_skin.h"
#include "skin_rig.h"

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

}  // namespace mrhi
