#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "mr_hand_interaction/rendering/rendered_hand.h"
#include "mr_hand_interaction/scene/shape.h"
#include "mr_hand_interaction/simulation_state.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

using Rgb = Eigen::Array3f;  ///< 0 to 1

/// Towards the main light (unit).
inline Eigen::Vector3f main_light() {
  return {0.3505f, -0.4506f, 0.8211f};
}

/// Light reflected by a white surface with this normal (world, unit): one light from above, a faint one from
/// below, and ambient light, of which the fraction `around` arrives. Fixed in world, so that a still surface
/// keeps its colours while the view turns. A channel may exceed 1.
///
///     main:      (n.l + wrap) / (1 + wrap), >= 0 (wrapped diffuse light: red goes farther round than blue)
///     all round: below + (1/2 + n_z/2) (above - below), as of a sky and a floor
inline Rgb light_on(const Eigen::Vector3f& normal, float around = 1.0f) {
  const Eigen::Vector3f main = main_light(), fill(-0.5514f, -0.4511f, -0.7018f);  // unit
  const Rgb main_colour(0.40f, 0.39f, 0.37f), fill_colour(0.20f, 0.19f, 0.18f);
  const Rgb above(0.62f, 0.63f, 0.65f), below(0.55f, 0.51f, 0.49f);
  const Rgb wrap(0.45f, 0.30f, 0.25f);  // light that goes on in the skin past where it would end
  const Rgb direct = (normal.dot(main) + wrap) / (1.0f + wrap);
  const Rgb ambient = below + (0.5f + 0.5f * normal.z()) * (above - below);
  const float from_below = 0.6f * std::max(0.0f, normal.dot(fill) + 0.4f);
  return main_colour * direct.max(0.0f) * (0.4f + 0.6f * around) +
         (ambient + fill_colour * from_below) * around;
}

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

/// Bytes of the models: for each vector its size (uint32) and its elements as in memory, little-endian.
std::string_view shipped_skins();

/// A smooth closed skin over a hand's bones: triangles that are made for the rest hand (modelling/). Each
/// hand, left or right and of any size, has the same ones, bent over its bones. Immutable.
class Skin {
 public:
  explicit Skin(SkinModel model) : model_(std::move(model)) {}
  /// Shared skins: for local rendering, for publishing triangles, and for a ghost.
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

struct SkinTone {
  Rgb skin = Rgb::Ones();                   ///< times the skin's own colours
  Rgb touching = Rgb(0.86f, 0.30f, 0.08f);  ///< where it presses
};

/// Colours of the vertices of a rendered hand's surface, light included: rviz draws coloured vertices unlit.
/// Redder around where the hand presses, and the more so the harder. Less light comes from around where
/// fingers cover each other or the palm (spheres as occluders).
void paint_skin(const Skin& skin, const RenderedHand& rendered, const SkinSurface& surface,
                std::vector<Rgb>& colours, const SkinTone& tone = {});

/// Flattens the pads of a hand's skin against what they press: skin that is nearer to the touched plane than
/// the pad's compression lies on it, and skin up to three times as far comes nearer. The compression grows
/// with the force as a fingertip's does, to kMaxPadCompression.
void flatten_pads(const std::vector<Contact>& contacts, const SimulationState& state, std::uint32_t hand,
                  const Skin& skin, SkinSurface& surface);

constexpr double kMaxPadCompression = 0.0018;  ///< [m]

}  // namespace mrhi
