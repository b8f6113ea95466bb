#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "light.h"
#include "mr_hand_interaction/scene/shape.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// The skin of one hand at one time, in world. Vertex i is the same place of every hand's skin.
struct SkinSurface {
  std::vector<Vector3> vertices;  ///< [m]
  std::vector<Vector3> normals;   ///< outward, unit
};

/// A skin as modelling/ makes it and as it ships: triangles on the rest hand, and what is computed for each
/// vertex and edge beforehand.
struct SkinModel {
  /// A bone that carries a vertex: the vertex's place along the bone as a fraction of its length, what is
  /// beyond its ends and beside it in radii, and the normal times the weight, both in the bone's axes.
  struct Influence {
    int bone;
    float weight, along;
    Eigen::Vector3f beyond, normal;
  };
  struct Look {
    Rgb colour;   ///< in white light
    float wrist;  ///< 0, or how far the vertex has faded away at the wrist, up to 1
    int capsule;  ///< that the vertex belongs to most
  };

  std::vector<Vector3> rest;  ///< vertices: right, stretched, fingers along x, back up, wrist at 0 [m]
  std::vector<std::array<int, 3>> triangles;  ///< counter-clockwise seen from outside
  std::vector<Influence> influences;          ///< of vertex 0, then of vertex 1, ...
  std::vector<std::uint32_t> ends;            ///< of each vertex's influences
  std::vector<Look> looks;                    ///< of each vertex

  /// Calls `visit` with each of the vectors, in the order in which they ship.
  template <typename Model, typename Visit>
  static void visit_parts(Model& model, Visit visit) {
    visit(model.rest), visit(model.triangles), visit(model.influences), visit(model.ends), visit(model.looks);
  }
};

/// Of a model, for each vector: its size (uint32) and its elements as they are in memory, little-endian.
std::string_view shipped_skins();

/// A smooth closed skin over a hand's bones: triangles that are made for the rest hand (modelling/). Each
/// hand, left or right and of any size, has the same ones, bent over its bones. Immutable.
class Skin {
 public:
  explicit Skin(SkinModel model) : model_(std::move(model)) {}
  /// What all share: for who bends it where it is drawn, for who sends its triangles, and for a ghost.
  static const Skin& detailed();
  static const Skin& human();
  static const Skin& outline();

  const SkinModel& model() const { return model_; }
  /// Counter-clockwise seen from outside, for a right hand; for a left one clockwise.
  const std::vector<std::array<int, 3>>& triangles() const { return model_.triangles; }
  const std::vector<Vector3>& rest() const { return model_.rest; }
  std::size_t size() const { return model_.rest.size(); }

  /// False, and the surface as it was, if a bone of the hand is missing (the thumb's metacarpal may be).
  bool pose(const Hand& hand, SkinSurface& surface) const;

 private:
  SkinModel model_;
};

/// Adds to each vertex the area of the triangles at it, outward, in units of the palm's width squared.
void add_facets(const std::vector<std::array<int, 3>>& triangles, const Hand& hand,
                const std::vector<Vector3>& vertices, std::vector<Vector3>& normals);

/// A bone for the skin to follow: x along it, z to the back of the hand, y = z x x (mirrored: x x z).
struct SkinBone {
  Vector3 start = Vector3::Zero();
  Matrix3 axes = Matrix3::Identity();  ///< columns; of a left hand, y is negated
  double length = 0.0;                 ///< [m]
  double radius = 0.0;                 ///< [m]
};

constexpr int kBendsPerFinger = kBonesPerFinger - 1;
constexpr int kFirstBend = kPhalanges;
constexpr int kWristBone = kFirstBend + kFingers * kBendsPerFinger;
constexpr int kSkinBones = kWristBone + 1;

/// The bone half-way between two phalanges, at the joint where phalanx `bone` begins; bone is 1 to 3.
constexpr int bend_index(int finger, int bone) {
  return kFirstBend + finger * kBendsPerFinger + bone - 1;
}

/// The thumb's metacarpal is not in the palm.
constexpr int first_bone(int finger) {
  return finger == 0 ? 1 : 0;
}

/// The hand's phalanges, the bends between them, and the wrist.
using SkinRig = std::array<SkinBone, kSkinBones>;

/// The right hand that the skin is modelled on: stretched, fingers spread, in the frame of HandSkeleton.
struct RestHand {
  Hand hand;
  SkinRig rig;
};
const RestHand& rest_hand();

/// Whether no bone is missing but the thumb's metacarpal.
bool has_whole_skin(const Hand& hand);

/// Bones turn from where the rest hand has them by the least rotation that each takes from the one before.
/// The hand must have a whole skin.
SkinRig pose_rig(const Hand& hand);

/// 0 at `from`, 1 at `to`, constant beyond, with no kink; `from` may be the greater. t^2 (3 - 2 t): its slope
/// is 0 at both ends.
inline double smooth_step(double from, double to, double x) {
  const double t = std::min(1.0, std::max(0.0, (x - from) / (to - from)));
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace mrhi
