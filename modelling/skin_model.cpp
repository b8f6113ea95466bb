#include "skin_model.h"

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/synthetic/hand_skeleton.h"
#include "rendering/skin.h"
#include "rendering/skin_rig.h"
#include "rendering/skin_shape.h"
#include "simplified_mesh.h"
#include "surface_net.h"

namespace mrhi {
namespace {

constexpr double kCell = 0.0038;  // length of the finest triangles' sides [m]
constexpr double kTipWorth = 4.0, kWebWorth = 20.0;
constexpr double kSleeveEdge = 0.005;  // [m]

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
      vertex += out * skin_normal(vertex);
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

}  // namespace

TriangleMesh finest_skin() {
  const SkinBox box = skin_box();
  return surface_net(skin_distance, box.lowest, box.highest, kCell);
}

TriangleMesh modelled_skin(std::size_t triangles) {
  static const Skin finest(finest_skin());
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

}  // namespace mrhi
