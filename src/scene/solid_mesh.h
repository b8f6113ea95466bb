#pragma once

#include <stdexcept>
#include <string>
#include <vector>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

struct MeshFile {
  std::string file;
  Vector3 scale;
};

/// All triangles of a file, vertices at the same place joined; or what is wrong with it.
struct LoadedMesh {
  TriangleMesh mesh;
  std::string problem;  ///< goes on from the file's name; empty: none
};

/// Reads what assimp reads: STL, OBJ, DAE, PLY, glTF. A DAE's units are taken, its up axis is not (as in
/// rviz). A child process reads all files, with limits on sizes, time, memory and triangles.
std::vector<LoadedMesh> load_meshes(const std::vector<MeshFile>& files);

/// A mesh that is a flat sheet, or nothing. what() goes on from the mesh's name.
class NoVolume : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Makes a solid of a surface. Each connected part is turned outward, or inward where it is a cavity of
/// another. Of doubled faces one is kept, vertices within 1e-4 of the extent are joined if that closes the
/// surface, edges are divided where another triangle's vertex is on them, and small holes are filled. Parts
/// that are open all the same become one convex hull; flat sheets beside solids are left out. `parts` is set
/// where solids overlap. Returns what was assumed, for warnings, each going on from the mesh's name. Throws
/// NoVolume.
std::vector<std::string> make_solid(TriangleMesh& mesh);

/// By the divergence theorem; negative if the triangles are turned inward [m^3].
double signed_volume(const TriangleMesh& mesh);

/// The convex hull of a mesh's vertices, by qhull. Throws NoVolume.
TriangleMesh convex_hull(const TriangleMesh& mesh);

/// The shapes with all meshes among them made one, of a part each: one tree to search.
std::vector<PlacedShape> with_meshes_joined(const std::vector<PlacedShape>& shapes);

/// Of the solids' union, about the origin of the frame that they are placed in. What they share counts once:
/// it is measured along some 10 000 lines, and neglected below 0.1 % of the volume.
SolidMoments moments_of(const std::vector<PlacedShape>& shapes);

/// Moments of inertia about the origin of solids of one density that weigh `mass` together [kg m^2]. Zero if
/// they have no volume. What they share counts once if a mesh is among them, else as often as it is there:
/// the inertia of a scene of boxes and cylinders is what it was in every recording.
Matrix3 inertia_of(const std::vector<PlacedShape>& shapes, double mass);

/// Of a closed mesh, whose parts count as often as they overlap.
SolidMoments signed_moments(const TriangleMesh& mesh);

/// What parts of closed surfaces overlap, as often as there are parts too many; zero where that is less than
/// 0.1 % of `volume`.
SolidMoments shared_moments(const TriangleMesh& mesh, double volume);

/// What holds a shape, along the axes of the frame that it is placed in.
Eigen::AlignedBox3d box_of(const PlacedShape& shape);

/// A shape's surface in the frame that it is placed in: a mesh itself, facets within a round shape.
TriangleMesh surface_of(const PlacedShape& shape);

/// Whether closed parts overlap.
bool overlaps_itself(const TriangleMesh& mesh);

}  // namespace mrhi
