#pragma once

#include <array>

#include "segment.h"

namespace mrhi {

/// What of a triangle a segment is nearest to.
enum class TrianglePart { face, edge, vertex };

struct TriangleNearest {
  double distance = 1e300;  ///< 0 where the segment goes through the triangle [m]
  Stretch stretch;          ///< of the segment; s0 == s1 unless it is parallel
  Vector3 point;            ///< of the triangle, facing the stretch's middle
  TrianglePart part = TrianglePart::face;
  int index = 0;  ///< edge from vertex `index` to the next, or vertex
};

struct Triangle {
  std::array<Vector3, 3> corners;
  Vector3 normal;  ///< unit, counter-clockwise

  TriangleNearest nearest(const Segment& segment) const;
  /// What of the segment is straight above or below the triangle; empty (s0 > s1) if nothing.
  Stretch over(const Segment& segment) const;

 private:
  TriangleNearest nearest_by_face(const Segment& segment) const;
  TriangleNearest nearest_by_edge(const Segment& segment, int edge) const;
};

}  // namespace mrhi
