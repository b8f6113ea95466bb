#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// A mesh that is a flat sheet, or nothing. what() goes on from the mesh's name.
class NoVolume : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Makes a solid of a surface. Each connected part is turned outward, or inward where it is a cavity of
/// another. Of doubled faces one is kept, vertices within 1e-4 of the extent are joined if that closes the
/// surface, and small holes are filled. Parts that are open all the same become one convex hull; flat sheets
/// beside solids are left out. `parts` is set where solids overlap. Returns what was assumed, for warnings,
/// each going on from the mesh's name. Throws NoVolume.
std::vector<std::string> make_solid(TriangleMesh& mesh);

/// By the divergence theorem; negative if the triangles are turned inward [m^3].
double signed_volume(const TriangleMesh& mesh);

/// The convex hull of a mesh's vertices, by qhull. Throws NoVolume.
TriangleMesh convex_hull(const TriangleMesh& mesh);

/// The shapes with all meshes among them made one, of a part each: one tree to search.
std::vector<PlacedShape> with_meshes_joined(const std::vector<PlacedShape>& shapes);

}  // namespace mrhi
