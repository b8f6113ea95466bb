#pragma once

#include <vector>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// A surface as its flat faces, however these are cut into triangles in a file: a polygon each, with corners
/// where it bends. Depends on the surface alone, not on the order of its triangles and vertices.
struct FlatFaces {
  struct Face {
    Vector3 normal;  ///< unit
    double height;   ///< of the plane above the origin, along the normal [m]
  };
  /// A straight line from corner to corner, with `face` on its left, seen from outside.
  struct Edge {
    int from, to;
    int face, other;  ///< other: -1 at the border of an open surface
  };

  std::vector<Vector3> corners;
  std::vector<Vector3> corner_normals;  ///< of any length: the sum of those around, by their angles
  std::vector<Face> faces;
  std::vector<Edge> edges;
  bool closed = true;
  bool one_piece = true;
};

/// Places that are out of a plane or a line by less than this part of the mesh's extent are on it: vertices
/// have passed through floats.
constexpr double kFlatness = 5e-7;

/// Throws std::invalid_argument if no triangle has an area.
FlatFaces flat_faces(const TriangleMesh& mesh);

}  // namespace mrhi
