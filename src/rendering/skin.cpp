#include "skin.h"

#include <algorithm>

#include "mr_hand_interaction/synthetic/hand_skeleton.h"
#include "simplified_mesh.h"
#include "skin_rig.h"
#include "skin_shape.h"
#include "skin_weights.h"
#include "surface_net.h"

namespace mrhi {
namespace {

constexpr double kCell = 0.0038;  // length of the finest triangles' sides [m]
constexpr std::size_t kHumanTriangles = 1200, kOutlineTriangles = 400;
constexpr double kTipWorth = 4.0, kWebWorth = 20.0;
constexpr double kSleeveEdge = 0.005;  // [m]
constexpr double kLeastWeight = 0.01;  // of a bone; less is left to the others

/// Columns that map an influence's place on its bone to world.
struct Carrier {
  Vector3 start, along;
  Matrix3 beyond, axes;
};

Carrier carrier(const SkinBone& bone) {
  return {bone.start, bone.length * bone.axes.col(0), bone.radius * bone.axes, bone.axes};
}

/// Adds the triangles' normals to those that the bones carry, which alone would be smooth also where skin
/// folds.
void add_facets(const std::vector<std::array<int, 3>>& triangles, double per_area, SkinSurface& surface) {
  constexpr double kWeight = 60.0;  // about as much as the bones' normals
  for (const auto& triangle : triangles) {
    const auto a = static_cast<std::size_t>(triangle[0]), b = static_cast<std::size_t>(triangle[1]),
               c = static_cast<std::size_t>(triangle[2]);
    const Vector3& corner = surface.vertices[a];
    const Vector3 area =
        kWeight * per_area * (surface.vertices[b] - corner).cross(surface.vertices[c] - corner);
    surface.normals[a] += area;
    surface.normals[b] += area;
    surface.normals[c] += area;
  }
  for (Vector3& normal : surface.normals) normal.normalize();
}

/// The rest hand with its fingers bent by these shares of the most that they can be, each second one by
/// `odd`.
Hand bent(double even, double odd) {
  HandPosture posture = HandPosture::Zero();
  for (int finger = 0; finger < kFingers; ++finger) {
    const auto& most = human_hand().fingers[static_cast<std::size_t>(finger)].upper;
    for (const int joint : {kBaseFlexion, kMiddleFlexion, kEndFlexion})
      posture(joint, finger) = (finger % 2 == 0 ? even : odd) * most[joint];
  }
  return complete_hand(hand_joints(human_hand(), Side::right, Pose{}, posture), Pose{});
}

/// Vertices go along the surface's normal until the triangles about each lie as much outside as inside, but
/// no farther out than is unseen in what is touched.
void settle(TriangleMesh& mesh) {
  constexpr int kPasses = 6;
  constexpr double kStandsOut = 0.0003;  // [m]
  std::vector<double> off(mesh.vertices.size());
  std::vector<int> counts(mesh.vertices.size());
  for (int pass = 0; pass < kPasses; ++pass) {
    std::fill(off.begin(), off.end(), 0.0);
    std::fill(counts.begin(), counts.end(), 0);
    for (const auto& triangle : mesh.triangles) {
      const auto corner = [&](std::size_t i) {
        return mesh.vertices[static_cast<std::size_t>(triangle[i % 3])];
      };
      double sum = skin_distance((corner(0) + corner(1) + corner(2)) / 3.0);
      for (std::size_t i = 0; i < 3; ++i)
        sum += skin_distance(corner(i)) / 3.0 + 0.5 * skin_distance(0.5 * (corner(i) + corner(i + 1)));
      for (const int v : triangle)
        off[static_cast<std::size_t>(v)] += sum / 3.5, ++counts[static_cast<std::size_t>(v)];
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      Vector3& vertex = mesh.vertices[v];
      const double out = std::min(-off[v] / counts[v], kStandsOut - skin_distance(vertex));
      vertex += out * gradient(skin_distance, vertex).normalized();
    }
  }
}

/// What is looked at, fingers and most of all their ends and the sleeve's edge, and what folds, the webs
/// between two fingers.
double worth_of(const Skin& skin, std::size_t vertex) {
  double worth = 1.0, all = 0.0, most = 0.0;
  for (int finger = 0; finger < kFingers; ++finger) {
    double of_finger = 0.0;
    for (int bone = 1; bone < kBonesPerFinger; ++bone)
      of_finger += skin.share(vertex, capsule_index(finger, bone));
    worth += of_finger + kTipWorth * skin.share(vertex, capsule_index(finger, 3));
    all += of_finger;
    most = std::max(most, of_finger);
  }
  if (std::abs(skin.rest()[vertex].x() - kSleeveBegins) < kSleeveEdge) worth += kTipWorth;
  return worth + kWebWorth * (all - most);
}

TriangleMesh rest_mesh(std::size_t triangles) {
  static const Skin finest;
  std::vector<Places> poses{finest.rest()};
  for (const Hand& hand :
       {complete_hand(hand_joints(human_hand(), Side::right, Pose{}, relaxed_posture()), Pose{}),
        complete_hand(hand_joints(human_hand(), Side::right, Pose{}, pointing_posture()), Pose{}),
        bent(0.5, 0.5), bent(0.95, 0.95), bent(0.0, 0.95), bent(0.95, 0.0), bent(0.3, 0.6), bent(0.6, 0.3)}) {
    SkinSurface surface;
    finest.pose(hand, surface);
    poses.push_back(surface.vertices);
  }
  std::vector<double> worth;
  for (std::size_t v = 0; v < finest.size(); ++v) worth.push_back(worth_of(finest, v));
  TriangleMesh mesh = simplified({finest.rest(), finest.triangles()}, poses, worth, triangles);
  settle(mesh);
  return mesh;
}

TriangleMesh finest_mesh() {
  const SkinBox box = skin_box();
  return surface_net(skin_distance, box.lowest, box.highest, kCell);
}

}  // namespace

Skin::Skin() : Skin(finest_mesh()) {}
Skin::Skin(std::size_t triangles) : Skin(rest_mesh(triangles)) {}

Skin::Skin(TriangleMesh rest) : rest_(std::move(rest.vertices)), triangles_(std::move(rest.triangles)) {
  for (const Vector3& vertex : rest_) {
    shares_.push_back(capsule_shares(vertex));
    const Vector3 normal = gradient(skin_distance, vertex).normalized();
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
  static const Skin skin(kHumanTriangles);
  return skin;
}

const Skin& Skin::outline() {
  static const Skin skin(kOutlineTriangles);
  return skin;
}

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
  add_facets(triangles_, (hand.side == Side::left ? -1.0 : 1.0) / (hand.palm_width * hand.palm_width),
             surface);
  return true;
}

}  // namespace mrhi
