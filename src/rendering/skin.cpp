#include "skin.h"

#include <algorithm>

#include "rest_skin.h"
#include "skin_rig.h"
#include "skin_shape.h"

namespace mrhi {
namespace {

constexpr double kLeastWeight = 0.01;  // of a bone; less is left to the others
constexpr double kFacets = 60.0;       // of the triangles' normals, about as much as the bones'

/// Columns that map an influence's place on its bone to world.
struct Carrier {
  Vector3 start, along;
  Matrix3 beyond, axes;
};

Carrier carrier(const SkinBone& bone) {
  return {bone.start, bone.length * bone.axes.col(0), bone.radius * bone.axes, bone.axes};
}

/// Adds to each vertex the area of the triangles at it, outward, as a share of the palm's width squared. The
/// cross product of two sides is twice the area along the normal; summed, large triangles count for more. A
/// left hand's triangles run clockwise, and the sign is turned.
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

}  // namespace

Skin::Skin(TriangleMesh rest) : rest_(std::move(rest.vertices)), triangles_(std::move(rest.triangles)) {
  // What the triangles' normals are off the shape's as they are made is nothing to be seen; what skin that
  // folds adds to it is. So the bones carry the difference.
  std::vector<Vector3> facets(size(), Vector3::Zero());
  add_facets(triangles_, rest_hand().hand, rest_, facets);
  for (std::size_t v = 0; v < size(); ++v) {
    const Vector3& vertex = rest_[v];
    shares_.push_back(capsule_shares(vertex));
    const Vector3 normal = (1.0 + facets[v].norm()) * skin_normal(vertex) - facets[v];
    auto weights = skin_weights(vertex);
    double sum = 0.0;
    for (double& weight : weights) sum += weight = weight < kLeastWeight ? 0.0 : weight;
    for (int b = 0; b < kSkinBones; ++b) {
      const auto i = static_cast<std::size_t>(b);
      if (weights[i] > 0.0) influences_.push_back(influence(b, weights[i] / sum, vertex, normal));
    }
    ends_.push_back(static_cast<std::uint32_t>(influences_.size()));
  }
}

/// A phalanx takes the place along it as a share of its length, and what is beyond its ends or beside it in
/// radii: longer bones stretch the skin, thicker ones widen it, and tips stay round.
Skin::Influence Skin::influence(int bone, double weight, const Vector3& vertex, const Vector3& normal) {
  const SkinBone& carrying = rest_hand().rig[static_cast<std::size_t>(bone)];
  Vector3 place = carrying.axes.transpose() * (vertex - carrying.start);
  double along = 0.0;
  if (bone < kPhalanges) {
    along = std::clamp(place.x(), 0.0, carrying.length);
    place.x() -= along;
  }
  return {bone, static_cast<float>(weight), static_cast<float>(along / carrying.length),
          (place / carrying.radius).cast<float>(),
          (weight * carrying.axes.transpose() * normal).cast<float>()};
}

const Skin& Skin::human() {
  static const Skin skin(rest_skin());
  return skin;
}

const Skin& Skin::outline() {
  static const Skin skin(rest_outline());
  return skin;
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
    for (; i < ends_[v]; ++i) {
      const Influence& influence = influences_[i];
      const Carrier& c = carriers[static_cast<std::size_t>(influence.bone)];
      place += influence.weight *
               (c.start + influence.along * c.along + c.beyond * influence.beyond.cast<double>());
      normal += c.axes * influence.normal.cast<double>();
    }
    surface.vertices[v] = place;
    surface.normals[v] = normal;
  }
  add_facets(triangles_, hand, surface.vertices, surface.normals);
  for (Vector3& normal : surface.normals) normal.normalize();
  return true;
}

}  // namespace mrhi
