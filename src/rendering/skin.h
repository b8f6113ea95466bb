#pragma once

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

}  // namespace mrhi
