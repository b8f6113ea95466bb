#pragma once

#include <vector>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

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

}  // namespace mrhi
