#pragma once

#include "box_face.h"
#include "contact_region.h"
#include "disc_overlap.h"
#include "segment.h"

namespace mrhi {

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

}  // namespace mrhi
