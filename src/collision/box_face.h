#pragma once

#include <array>
#include <cstdint>

#include "contact_region.h"
#include "oriented_shapes.h"

namespace mrhi {

/// A box has corners 0..7 (bit i set: on the positive side of axis i) and edges 0..11 (4 * direction + two
/// bits for the sides of the axes that follow). Touches of boxes a, b are named: corner of a, 8 + corner of
/// b, 16 + 12 * edge of a + edge of b.
constexpr int kBoxCorners = 8, kBoxEdges = 12;

inline int edge_name(int direction, int corner) {
  return 4 * direction + (corner >> ((direction + 1) % 3) & 1) + 2 * (corner >> ((direction + 2) % 3) & 1);
}
inline std::uint8_t crossing_name(int edge_of_a, int edge_of_b) {
  return static_cast<std::uint8_t>(2 * kBoxCorners + kBoxEdges * edge_of_a + edge_of_b);
}

/// One side of a box. Corners go round; edge i leads from corner i to the next, and stands on the side
/// kSides[i] of the face.
struct BoxFace {
  BoxFace(const OrientedBox& box, const Vector3& outward);

  Vector3 corner(std::size_t i) const {
    return centre + kCorner[i][0] * half[0] * along[0] + kCorner[i][1] * half[1] * along[1];
  }
  double area() const { return 4.0 * half[0] * half[1]; }

  static constexpr double kCorner[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};

  Vector3 centre, normal;
  std::array<Vector3, 2> along;
  std::array<double, 2> half;
  std::array<int, 4> corners, edges;
};

/// Border i of a face: the points with sign * coordinate[dimension] = half[dimension].
struct Border {
  int dimension;
  double sign;
};
constexpr std::array<Border, 4> kBorders{{{1, 1.0}, {0, -1.0}, {1, -1.0}, {0, 1.0}}};

/// The part of one box's face that stands over another's, in the other's coordinates along its sides; depth
/// is below the other's plane.
ContactRegion clip_face(const BoxFace& reference, const BoxFace& incident, bool reference_is_a);

}  // namespace mrhi
