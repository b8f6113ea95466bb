#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mr_hand_interaction/scene/shape.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// The skin of one hand at one time, in world. Vertex i is the same place of every hand's skin.
struct SkinSurface {
  std::vector<Vector3> vertices;  ///< [m]
  std::vector<Vector3> normals;   ///< outward, unit
};

/// A smooth closed skin over a hand's bones: triangles that are made for the rest hand (modelling/). Each
/// hand, left or right and of any size, has the same ones, bent over its bones. Immutable.
class Skin {
 public:
  /// Of a mesh on the rest hand's surface.
  explicit Skin(TriangleMesh rest);
  /// What all share: a hand's, and a coarser one for what is only to be made out.
  static const Skin& human();
  static const Skin& outline();

  /// Counter-clockwise seen from outside, for a right hand; for a left one clockwise.
  const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }
  /// The vertices of the rest hand: right, stretched, fingers along x, back up, wrist at the origin [m].
  const std::vector<Vector3>& rest() const { return rest_; }
  std::size_t size() const { return rest_.size(); }

  /// False, and the surface as it was, if a bone of the hand is missing (the thumb's metacarpal may be).
  bool pose(const Hand& hand, SkinSurface& surface) const;

  /// How far vertex i belongs to each capsule, 0 to 1.
  double share(std::size_t vertex, int capsule) const {
    return shares_[vertex][static_cast<std::size_t>(capsule)];
  }

 private:
  /// A bone that carries a vertex, and where it is on that bone: along it as a share of its length, what is
  /// beyond its ends, and to the sides in radii; and its normal, times the weight. Small, as each frame reads
  /// them all.
  struct Influence {
    int bone;
    float weight, along;
    Eigen::Vector3f beyond, normal;
  };
  static Influence influence(int bone, double weight, const Vector3& vertex, const Vector3& normal);

  std::vector<Vector3> rest_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<Influence> influences_;
  std::vector<std::uint32_t> ends_;  // of each vertex's influences
  std::vector<std::array<float, kCapsules>> shares_;
};

}  // namespace mrhi
