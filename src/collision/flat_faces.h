#pragma once

#include <cstddef>
#include <vector>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// Where a list has what is told by its number.
inline std::size_t slot(int number) {
  return static_cast<std::size_t>(number);
}

/// The mesh with its vertices in the order of their places, those at one place joined, and its triangles in
/// the order of their vertices: the same for any order in a file. Vertices that no triangle has are left out.
TriangleMesh sorted(const TriangleMesh& mesh);

/// Of each triangle's three sides (from vertex k to the next) the triangle and the side beyond it.
class Neighbourhood {
 public:
  struct Side {
    int triangle = -1, side = 0;
    bool exists() const { return triangle >= 0; }
  };

  explicit Neighbourhood(const TriangleMesh& mesh);

  const Side& beyond(int triangle, int side) const {
    return beyond_[static_cast<std::size_t>(triangle)][static_cast<std::size_t>(side)];
  }
  bool closed() const { return closed_; }        ///< every side has one beyond it, that runs the other way
  bool one_piece() const { return one_piece_; }  ///< every triangle is reached from every other

 private:
  void find_pieces();

  std::vector<std::array<Side, 3>> beyond_;
  bool closed_ = true, one_piece_ = true;
};

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
/// have passed through floats. A float's half ulp is 6e-8 of a coordinate. A mesh that lies far from its own
/// origin, against its size, has more rounding than this allows for, and is cut into more faces.
constexpr double kFlatness = 5e-7;

/// Throws std::invalid_argument if no triangle has an area.
FlatFaces flat_faces(const TriangleMesh& mesh);

}  // namespace mrhi
