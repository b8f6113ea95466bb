#pragma once

#include "box_face.h"
#include "contact_region.h"
#include "mr_hand_interaction/collision/body_manifold.h"
#include "oriented_shapes.h"
#include "segment.h"

namespace mrhi {

/// The cap of a cylinder whose outward normal is nearer to `outward`.
struct Disc {
  Disc(const OrientedCylinder& cylinder, const Vector3& outward);

  double area() const { return 3.141592653589793 * radius * radius; }
  Vector3 at(double angle) const {
    return centre + radius * (std::cos(angle) * along[0] + std::sin(angle) * along[1]);
  }

  Vector3 centre, normal;
  std::array<Vector3, 2> along;
  double radius;
  int cap;  ///< 0 at the axis' start, 1 at its end
};

/// A cap against a flat face of another body, seen along `normal` (out of b towards a), in the cap's
/// coordinates. The cap touches with four points of its rim that are fixed to it while it lies flat; as it
/// tilts they turn until one is the lowest. Where part of the rim overhangs, with what is left. Named: 4 *
/// cap + rim point of this disc; the others below.
class DiscOverlap {
 public:
  /// The face has the outward normal `face_normal` at `face_point`.
  DiscOverlap(const Disc& disc, bool disc_is_a, const Vector3& normal, const Vector3& face_point,
              const Vector3& face_normal);

  ContactRegion with_face(const BoxFace& face) const;  ///< 8 + corner, 16 + 2 * edge + end of its chord
  ContactRegion with_disc(const Disc& other) const;  ///< 8 + 4 * cap + rim point of it, 16 and 17: rims cross
  void add_to(Manifold& manifold, const ContactRegion& region) const;

 private:
  using Place = std::array<double, 2>;

  RegionPoint at(const Place& place, int feature) const;
  Place project(const Vector3& point) const;
  std::array<Place, 4> rim_points() const;
  void add_chord(const Place& from, const Place& to, int corner, int edge, ContactRegion& region) const;
  double from_centre(const Disc& other, const Place& place) const;
  void add_crossings(const Disc& other, ContactRegion& region) const;

  const Disc& disc_;
  bool disc_is_a_;
  Vector3 normal_;
  double depth_;                 // at the disc's centre
  std::array<double, 2> slope_;  // of the depth
  double tolerance_;
};

/// Four places round a disc's rim [rad]; one of them at the lowest, where `slope` (of the depth, by the
/// disc's coordinates) tilts it noticeably.
std::array<double, 4> rim_angles(double radius, const std::array<double, 2>& slope);

/// A straight piece of surface: an edge of a box, a line of a cylinder's side, or (half = 0) a point.
struct Line {
  Vector3 middle, along;  ///< along is unit
  double half;

  Vector3 at(double t) const { return middle + t * along; }
};

/// The line of the cylinder's side that is farthest along `facing`.
Line side_line(const OrientedCylinder& cylinder, const Vector3& facing);

/// A side line that lies on a face of the other body: both its ends, or where it leaves the face. Names: 0, 1
/// the ends; 2 + 4 * end + border of a box's face; 10 + end at a rim.
Manifold line_on_face(const Line& line, bool line_is_a, const BoxFace& face, double margin);
Manifold line_on_disc(const Line& line, bool line_is_a, const Disc& disc, double margin);

/// Two lines that face each other along `normal` (out of b towards a): at two points (names `feature`, + 1)
/// where they are parallel, which draw together while they turn across each other; at one where they cross.
Manifold line_on_line(const Line& a, const Line& b, const Vector3& normal, int feature);

/// Depth of the deepest point; -1e300 if there is none.
double deepest_depth(const Manifold& manifold);

/// What touches by a cap or a box's face, if the axis n of least overlap (out of b towards a, `separation` <
/// 0) is near the normal of one.
struct FlatContact {
  Manifold manifold;
  bool found = false;    ///< as deep as the axis says
  bool certain = false;  ///< no axis can be better, whichever others there are
};
FlatContact flat_contact(const OrientedCylinder& a, const OrientedBox& b, const Vector3& n, double separation,
                         double margin);
FlatContact flat_contact(const OrientedCylinder& a, const OrientedCylinder& b, const Vector3& n,
                         double separation, double margin);

}  // namespace mrhi
