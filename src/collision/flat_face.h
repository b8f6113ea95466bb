#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "contact_region.h"
#include "prism.h"

namespace mrhi {

/// A prism on a rectangle has corners 0..7 (bit i set: on the positive side of axis i) and edges 0..11 (4 *
/// direction + two bits for the sides of the axes that follow), one on a disc corners 4 * cap + rim point,
/// and what is round there is edge 0. Touches of a and b are named: corner of a, 8 + corner of b, 16 + 12 *
/// edge of a + edge of b. With 12 edges each, 16 + 12 * 11 + 11 = 159 is the last: a byte holds it, and
/// leaves 200 on for lines.
constexpr int kCorners = 8, kEdges = 12;

inline int edge_name(int direction, int corner) {
  return 4 * direction + (corner >> ((direction + 1) % 3) & 1) + 2 * (corner >> ((direction + 2) % 3) & 1);
}
inline std::uint8_t corner_name(int corner, bool of_a) {
  return static_cast<std::uint8_t>(of_a ? corner : kCorners + corner);
}
inline std::uint8_t crossing_name(int edge_of_a, int edge_of_b) {
  return static_cast<std::uint8_t>(2 * kCorners + kEdges * edge_of_a + edge_of_b);
}

/// A straight piece of surface: an edge, a line of a round side, or (half = 0) a point.
struct Line {
  Vector3 middle, along;  ///< along is unit
  double half;
  int name;  ///< of the edge; kEdges + the corner's

  Vector3 at(double t) const { return middle + t * along; }
};

/// Part of a shape that is perpendicular to a direction: a flat face with its outline, or a line. Corners of
/// a rectangle are in cyclic order; edge i leads from corner i to the next, and is on the side kBorders[i].
///
/// A place (x, y) on it is centre + x along[0] + y along[1]; its normal points out of its own shape. Of a
/// face along[0] x along[1] is the normal or its opposite: corners go round left or right.
struct FlatFace {
  enum class Outline { rectangle, circle, line };

  static FlatFace of(const Line& line);

  bool is(Outline other) const { return outline == other; }
  Vector3 at(const Place& place) const { return centre + place[0] * along[0] + place[1] * along[1]; }
  Vector3 on_circle(double angle) const {
    return at({{half[0] * std::cos(angle), half[0] * std::sin(angle)}});
  }
  double size() const { return is(Outline::line) ? half[0] : std::min(half[0], half[1]); }
  double area() const { return (is(Outline::circle) ? 3.141592653589793 : 4.0) * half[0] * half[1]; }
  double to_border(const Vector3& point) const;  ///< from a place over it, across its normal; < 0: outside

  Vector3 centre, normal;  ///< a line has no normal
  std::array<Vector3, 2> along;
  std::array<double, 2> half;  ///< of a circle the radius, twice
  Outline outline;
  std::array<int, 4> corners, edges;
};
constexpr double kCorner[4][2] = {{1, 1}, {-1, 1}, {-1, -1}, {1, -1}};

/// Ends of an edge of a rectangle's prism: corners. Undoes edge_name: the two bits go back to the axes that
/// follow the direction; along it one end has 0, the other 1.
inline std::array<int, 2> edge_ends(int edge) {
  const int direction = edge / 4;
  const int low = (edge & 1) << (direction + 1) % 3 | (edge >> 1 & 1) << (direction + 2) % 3;
  return {{low, low | 1 << direction}};
}

/// The flat face whose outward normal is nearest to `outward`.
FlatFace face_towards(const Prism& prism, const Vector3& outward);

/// Part of the prism that lies on a plane with the normal `outward`: a face, or the line of a round side.
FlatFace lying_towards(const Prism& prism, const Vector3& outward);

/// Line of the prism that is perpendicular to a direction within `tolerance` (the cosine) and farthest along
/// it; the edge along `beside` if there are two. A point if there is none.
Line line_facing(const Prism& prism, const Vector3& n, double tolerance, const Vector3& beside);

/// The line of a round side that is farthest along `facing`. The tolerance lets any direction pass, even one
/// aslant.
inline Line side_line(const Prism& prism, const Vector3& facing) {
  constexpr double kAny = 2.0;
  return line_facing(prism, facing, kAny, prism.axis());
}

/// Four places round a rim [rad]; one of them at the lowest, where `slope` (of the depth, by the face's
/// coordinates) tilts it noticeably.
std::array<double, 4> rim_angles(double radius, const Place& slope);

/// Manifold of two faces along the normal of `reference`: at most four corners of their overlap.
Manifold touch(const FlatFace& reference, const FlatFace& incident, bool reference_is_a, double margin);

/// Two lines that face each other along `normal` (out of b towards a): at two points (names `feature`, + 1)
/// where they are parallel, which draw together while they turn across each other; at one where they cross.
Manifold line_on_line(const Line& a, const Line& b, const Vector3& normal, int feature);

}  // namespace mrhi
