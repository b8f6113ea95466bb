#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "body_manifold.h"
#include "prism.h"

namespace mrhi {

/// Normals nearer than this (2.5 degrees) to a face's count as that face's. 1 - cos(2.5 degrees) is about a
/// thousandth: as much as a depth along the face's normal may differ from that along n by their angle alone.
constexpr double kSameFace = 0.99905;
/// Faces of sizes nearer than this are as large.
constexpr double kSameSize = 1e-6;

/// True if a face's deepest point is as deep as the best direction requires: within a thousandth, as
/// kSameFace allows for, and 3 um, so that a body that only just touches still lies on its face.
inline bool as_deep(double deepest, double separation) {
  return deepest >= -separation - 1e-3 * std::abs(separation) - 3e-6;
}

using Place = std::array<double, 2>;

/// Twice the signed area of the triangle o, p, q: > 0 where p to q turns left, seen from o.
inline double cross(const Place& o, const Place& p, const Place& q) {
  return (p[0] - o[0]) * (q[1] - o[1]) - (p[1] - o[1]) * (q[0] - o[0]);
}

/// A corner of the region in which two faces overlap, seen along the normal: across the face, and how deep.
/// While a face is clipped, `line` leads on from it: edge 0..3 of that face, or border 4..7 of the other.
struct RegionPoint {
  Place place;
  double depth;
  std::uint8_t feature;
  int line;
};

/// The corners of such a region, a convex polygon, in their order. A polygon of four corners gains at most
/// one with each of four borders; a rim counts with four points and two crossings with each edge or rim.
struct ContactRegion {
  std::array<RegionPoint, 12> points;  ///< two rims have ten, a rim and a rectangle twelve
  int count = 0;

  ContactRegion() = default;
  ContactRegion(const ContactRegion& other) { *this = other; }
  /// Copies the points that there are.
  ContactRegion& operator=(const ContactRegion& other) {
    count = other.count;
    std::copy_n(other.points.begin(), count, points.begin());
    return *this;
  }
  void add(const RegionPoint& point) { points[count++] = point; }
  RegionPoint& operator[](int i) { return points[i]; }
  const RegionPoint& operator[](int i) const { return points[i]; }
  double deepest() const;  ///< -1e300 if empty

  void remove_gaps(double margin);
  /// Orders points by their angle about the middle.
  void sort_around();
  /// Keeps at most four points, the deepest among them, that keep the region large.
  void reduce();
  /// Drops collinear points, but not the deepest.
  void straighten();

 private:
  void erase(int i);
  double triangle(int i) const;
  std::uint8_t first_deepest() const;
};

/// Mean distance of a convex polygon's points from the mean of its corners, over that of its corners: the
/// lever of the friction of a spinning face under an even load. 1/2 for a line, 1 for a point. At most four
/// corners.
double spread_of(std::array<Place, 4> corners, int count);

/// True if the face of `a` gives the normal where both could: the larger one (the floor's, not the cube's);
/// among equals the one that is below, for a fixed direction of below.
bool first_is_reference(double area_a, double area_b, const Vector3& normal);

/// Largest distance of a touching corner beyond a face's border [m]: neither rounding nor creep must change
/// the features of two aligned boxes. `slope` is the tangent of the angle between the faces.
double border_tolerance(double size, double slope);

inline void add_point(Manifold& manifold, const Vector3& point, double depth, int feature) {
  manifold.points[manifold.count++] = {point, depth, static_cast<std::uint8_t>(feature)};
}

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
/// a rectangle are in cyclic order, left or right about the normal; edge i leads from corner i to the next,
/// and is on the side kBorders[i]. A place (x, y) on it is centre + x along[0] + y along[1].
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

/// Corners at the ends of an edge of a rectangle's prism: the inverse of edge_name().
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

/// The line of a round side that is farthest along `facing`, whatever its angle.
inline Line side_line(const Prism& prism, const Vector3& facing) {
  constexpr double kAnyDirection = 2.0;
  return line_facing(prism, facing, kAnyDirection, prism.axis());
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
