#include "skin_model.h"

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/tracking/hand_skeleton.h"
#include "simplified_mesh.h"
#include "skin_parts.h"
#include "skin_shape.h"
#include "surface_net.h"

namespace mrhi {
namespace {

constexpr double kCell = 0.0026, kDetailedCell = 0.0015;  // length of the finest triangles' sides [m]
constexpr double kOntoLine = 0.45 * kDetailedCell;
constexpr double kTipWorth = 4.0, kWebWorth = 20.0, kSleeveWorth = 0.6;
constexpr double kLeastWeight = 0.01;  // of a bone; less is left to the others

Hand hand_in(const HandPosture& posture) {
  return complete_hand(hand_joints(human_hand(), Side::right, Pose{}, posture), Pose{});
}

/// With the thumb against the fingers: skin folds between them.
HandPosture bar_grip() {
  HandPosture degrees;
  degrees << 20, -20, -20, 0, -4,  //
      38, 49, 49, 80, 80,          //
      7, 37, 46, 95, 95,           //
      13, 24, 30, 60, 60,          //
      33, 0, 0, 0, 0;
  return M_PI / 180.0 * degrees;
}
HandPosture cube_grip() {
  HandPosture degrees;
  degrees << 44, -11, 1, 12, -4,  //
      23, 42, 38, 46, 55,         //
      26, 38, 50, 31, 45,         //
      36, 28, 34, 21, 30,         //
      18, 0, 0, 0, 0;
  return M_PI / 180.0 * degrees;
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
  return hand_in(posture);
}

/// Vertices go along the surface's normal until the triangles about each lie as much outside as inside, but
/// no farther out than is unseen in what is touched.
void settle(const DistanceField& distance, TriangleMesh& mesh) {
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
      double sum = distance((corner(0) + corner(1) + corner(2)) / 3.0);
      for (std::size_t i = 0; i < 3; ++i)
        sum += distance(corner(i)) / 3.0 + 0.5 * distance(0.5 * (corner(i) + corner(i + 1)));
      for (const int v : triangle)
        off[static_cast<std::size_t>(v)] += sum / 3.5, ++counts[static_cast<std::size_t>(v)];
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      Vector3& vertex = mesh.vertices[v];
      const double out = std::min(-off[v] / counts[v], kStandsOut - distance(vertex));
      vertex += out * gradient(distance, vertex).normalized();
    }
  }
}

/// What is looked at, fingers and most of all their ends, and what folds, the webs between two fingers; least
/// of all the sleeve.
double worth_of(const Vector3& vertex) {
  if (skin_sleeve(vertex).covers) return kSleeveWorth;
  const auto shares = capsule_shares(vertex);
  const auto share = [&](int finger, int bone) {
    return shares[static_cast<std::size_t>(capsule_index(finger, bone))];
  };
  double worth = 1.0, all = 0.0, most = 0.0;
  for (int finger = 0; finger < kFingers; ++finger) {
    double of_finger = 0.0;
    for (int bone = 1; bone < kBonesPerFinger; ++bone) of_finger += share(finger, bone);
    worth += of_finger + kTipWorth * share(finger, 3);
    all += of_finger;
    most = std::max(most, of_finger);
  }
  return worth + kWebWorth * (all - most);
}

/// Nails and sleeve raised, nails' edges, creases and what the sleeve shades sunk: no posture, but what keeps
/// triangles' sides along them.
Places with_relief(const Skin& skin, bool creases) {
  constexpr double kRelief = 0.0025;  // [m]
  Places places;
  for (const Vector3& vertex : skin.rest()) {
    const SkinNail here = skin_nail(vertex);
    const SkinSleeve sleeve = skin_sleeve(vertex);
    const double sunk = here.edge + sleeve.shade + (creases ? skin_crease(vertex) : 0.0);
    places.push_back(vertex + kRelief * (here.nail + sleeve.covers - sunk) * skin_normal(vertex));
  }
  return places;
}

/// A phalanx takes the place along it as a fraction of its length, and what is beyond its ends or beside it
/// in radii: longer bones stretch the skin, thicker ones widen it, and tips stay round.
SkinModel::Influence influence(int bone, double weight, const Vector3& vertex, const Vector3& normal) {
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

}  // namespace

/// What the triangles' normals are off the shape's as they are made is nothing to be seen; what skin that
/// folds adds to it is. So the bones carry the difference.
SkinModel skinned(const TriangleMesh& rest, bool detailed) {
  const DistanceField distance = detailed ? detailed_skin_distance : skin_distance;
  SkinModel model{rest.vertices, rest.triangles, {}, {}, {}};
  std::vector<Vector3> facets(rest.vertices.size(), Vector3::Zero());
  add_facets(rest.triangles, rest_hand().hand, rest.vertices, facets);
  for (std::size_t v = 0; v < rest.vertices.size(); ++v) {
    const Vector3& vertex = rest.vertices[v];
    model.looks.push_back(skin_look(vertex, detailed));
    const Vector3 normal = (1.0 + facets[v].norm()) * gradient(distance, vertex).normalized() - facets[v];
    auto weights = skin_weights(vertex);
    double sum = 0.0;
    for (double& weight : weights) sum += weight = weight < kLeastWeight ? 0.0 : weight;
    for (int b = 0; b < kSkinBones; ++b) {
      const double weight = weights[static_cast<std::size_t>(b)];
      if (weight > 0.0) model.influences.push_back(influence(b, weight / sum, vertex, normal));
    }
    model.ends.push_back(static_cast<std::uint32_t>(model.influences.size()));
  }
  return model;
}

TriangleMesh finest_skin(bool detailed) {
  const SkinBox box = skin_box();
  TriangleMesh mesh = surface_net(skin_distance, box.lowest, box.highest, detailed ? kDetailedCell : kCell);
  if (detailed)
    for (Vector3& vertex : mesh.vertices) vertex = onto_hem(onto_crease(vertex, kOntoLine), kOntoLine);
  return mesh;
}

TriangleMesh modelled_skin(std::size_t triangles) {
  const bool detailed = triangles > kHumanTriangles;
  const Skin finest(skinned(finest_skin(detailed), detailed));
  std::vector<Places> poses{finest.rest()};
  for (const Hand& hand :
       {hand_in(relaxed_posture()), hand_in(pointing_posture()), hand_in(bar_grip()), hand_in(cube_grip()),
        bent(0.5, 0.5), bent(0.95, 0.95), bent(0.0, 0.95), bent(0.95, 0.0), bent(0.3, 0.6), bent(0.6, 0.3)}) {
    SkinSurface surface;
    finest.pose(hand, surface);
    poses.push_back(surface.vertices);
  }
  if (triangles > kOutlineTriangles)
    poses.push_back(with_relief(finest, detailed));  // the ghost has no nails
  std::vector<double> worth;
  for (const Vector3& vertex : finest.rest()) worth.push_back(worth_of(vertex));
  TriangleMesh mesh = simplified({finest.rest(), finest.triangles()}, poses, worth, triangles);
  settle(detailed ? detailed_skin_distance : skin_distance, mesh);
  return mesh;
}

}  // namespace mrhi
