#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "body_manifold.h"

namespace mrhi {

/// Normals nearer than this (2.5 degrees) to a face's count as that face's. 1 - cos(2.5 degrees) is about a
/// thousandth: as much as a depth along the face's normal may differ from that along n by their angle alone.
constexpr double kSameFace = 0.99905;
/// Faces of sizes nearer than this are as large.
constexpr double kSameSize = 1e-6;

/// A face's deepest point may differ so much from the depth along the best direction. By a thousandth, as
/// kSameFace allows for, and by 3 um, so that what only just touches, where a thousandth is nothing, still
/// lies on its face.
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

/// The corners of such a region, a convex polygon, in their order.
///
/// `points` holds what clipping may make of two faces: a convex polygon of four corners gains at most one
/// with each of four borders, and a rim counts with four points and two crossings with each edge or rim.
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
  void add(const RegionPoint& point) { points[static_cast<std::size_t>(count++)] = point; }
  RegionPoint& operator[](int i) { return points[static_cast<std::size_t>(i)]; }
  const RegionPoint& operator[](int i) const { return points[static_cast<std::size_t>(i)]; }
  double deepest() const;  ///< -1e300 if empty

  void remove_gaps(double margin);
  /// Puts points in the order of their angle about the middle.
  void sort_around();
  /// Leaves at most four points, the deepest among them, that keep the region large. Points within rounding
  /// of each other's claims always lose in the same order.
  void reduce();
  /// Drops points, but the deepest, that others span a line through.
  void straighten();

 private:
  void erase(int i);
  double triangle(int i) const;
  std::uint8_t first_deepest() const;
};

/// Ratio of the mean distance of a convex polygon's points from the mean of its corners to that of the
/// corners: a spinning face under an even load has the friction of all its points. 1/2 for a line, 1 for a
/// point. At most four corners, in any order.
double spread_of(std::array<Place, 4> corners, int count);

/// True if the face of `a` should be the one that gives the normal, where both could: the larger, so that it
/// is the floor's rather than the cube's; among equals the one that is below, for a fixed idea of below.
bool first_is_reference(double area_a, double area_b, const Vector3& normal);

/// Largest distance of a touching corner beyond a face's border [m]: neither rounding nor creep must change
/// the features of two aligned boxes. `slope` is the tangent of the angle between the faces. The corner is
/// moved to the border, which changes its depth by slope times the distance, less than 1 um.
double border_tolerance(double size, double slope);

inline void add_point(Manifold& manifold, const Vector3& point, double depth, int feature) {
  manifold.points[static_cast<std::size_t>(manifold.count++)] = {point, depth,
                                                                 static_cast<std::uint8_t>(feature)};
}

}  // namespace mrhi
