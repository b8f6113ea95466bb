#include "mr_hand_interaction/rendering/skin.h"

#include <algorithm>

#include "skin_rig.h"
#include "skin_shape.h"
#include "skin_weights.h"
#include "surface_net.h"

namespace mrhi {
namespace {

constexpr double kCell = 0.0048;       // length of the triangles' sides [m]
constexpr double kLeastWeight = 0.01;  // of a bone; less is left to the others

/// Columns that map an influence's place on its bone to world.
struct Carrier {
  Vector3 start, along;
  Matrix3 beyond;
};

Carrier carrier(const SkinBone& bone) {
  return {bone.start, bone.length * bone.axes.col(0), bone.radius * bone.axes};
}

void set_normals(const std::vector<std::array<int, 3>>& triangles, double sign, SkinSurface& surface) {
  std::fill(surface.normals.begin(), surface.normals.end(), Vector3::Zero());
  for (const auto& triangle : triangles) {
    const auto a = static_cast<std::size_t>(triangle[0]), b = static_cast<std::size_t>(triangle[1]),
               c = static_cast<std::size_t>(triangle[2]);
    const Vector3& corner = surface.vertices[a];
    const Vector3 area = (surface.vertices[b] - corner).cross(surface.vertices[c] - corner);
    surface.normals[a] += area;
    surface.normals[b] += area;
    surface.normals[c] += area;
  }
  for (Vector3& normal : surface.normals) {
    const double length = normal.norm();
    normal = length > 0.0 ? Vector3(sign / length * normal) : Vector3::UnitZ();
  }
}

}  // namespace

Skin::Skin() {
  const SkinBox box = skin_box();
  const TriangleMesh rest = surface_net(skin_distance, box.lowest, box.highest, kCell);
  rest_ = rest.vertices;
  triangles_ = rest.triangles;
  for (const Vector3& vertex : rest_) {
    Part part{influences_.size(), 0, capsule_shares(vertex)};
    auto weights = skin_weights(vertex);
    double sum = 0.0;
    for (double& weight : weights) sum += weight = weight < kLeastWeight ? 0.0 : weight;
    for (int b = 0; b < kSkinBones; ++b) {
      const auto i = static_cast<std::size_t>(b);
      if (weights[i] > 0.0) influences_.push_back(influence(b, weights[i] / sum, vertex));
    }
    part.last = influences_.size();
    parts_.push_back(part);
  }
}

Skin::Influence Skin::influence(int bone, double weight, const Vector3& vertex) {
  const SkinBone& carrying = rest_hand().rig[static_cast<std::size_t>(bone)];
  Vector3 place = carrying.axes.transpose() * (vertex - carrying.start);
  Influence influence{bone, weight, 0.0, Vector3::Zero()};
  if (bone < kPhalanges) {
    const double along = std::clamp(place.x(), 0.0, carrying.length);
    influence.along = along / carrying.length;
    place.x() -= along;
  }
  influence.beyond = place / carrying.radius;
  return influence;
}

const Skin& Skin::human() {
  static const Skin skin;
  return skin;
}

bool Skin::pose(const Hand& hand, SkinSurface& surface) const {
  if (!has_whole_skin(hand)) return false;
  const SkinRig rig = pose_rig(hand);
  std::array<Carrier, kSkinBones> carriers;
  std::transform(rig.begin(), rig.end(), carriers.begin(), carrier);
  surface.vertices.resize(size());
  surface.normals.resize(size());
  for (std::size_t v = 0; v < size(); ++v) {
    Vector3 place = Vector3::Zero();
    for (std::size_t i = parts_[v].first; i < parts_[v].last; ++i) {
      const Influence& influence = influences_[i];
      const Carrier& c = carriers[static_cast<std::size_t>(influence.bone)];
      place += influence.weight * (c.start + influence.along * c.along + c.beyond * influence.beyond);
    }
    surface.vertices[v] = place;
  }
  set_normals(triangles_, hand.side == Side::left ? -1.0 : 1.0, surface);
  return true;
}

}  // namespace mrhi
