#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// What is made of a file: its surface as it is, a solid by make_solid(), or that of the convex hull.
enum class MeshUse { surface, solid, hull };

struct MeshFile {
  std::string file;
  Vector3 scale;
  MeshUse use = MeshUse::surface;
};

/// The limits of a scene's meshes together; load_meshes() subtracts what it uses.
struct MeshBudget {
  std::size_t triangles = 1'000'000;
  double seconds = 40.0;  ///< of processor time; each child process has 20 s of real time
};

/// All triangles of a file, with coincident vertices joined; or the reason why it cannot be used.
struct LoadedMesh {
  TriangleMesh mesh;
  std::string problem;                 ///< continues a message after the file's name; empty: none
  std::vector<std::string> files;      ///< other files that it was read from, relative to its folder
  std::vector<std::string> assumed{};  ///< by make_solid()
  bool is_flat = false;                ///< the problem is that of NoVolume
};

/// Reads the formats that assimp reads: STL, OBJ, DAE, PLY, glTF. Applies a DAE's unit, but not its up axis
/// (as in rviz). Files that a mesh names are read in or below its folder only. A child process reads all
/// files and makes the solids, with limits on sizes, time, memory and triangles. Throws std::runtime_error
/// once `is_cancelled`.
std::vector<LoadedMesh> load_meshes(const std::vector<MeshFile>& files, MeshBudget& budget,
                                    const std::function<bool()>& is_cancelled = {});

/// Error of a mesh that is flat or empty. what() continues a message after the mesh's name.
class NoVolume : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Makes a solid of a surface. Orients each connected part outward, or inward if it is a cavity of another.
/// Keeps one of doubled faces, joins vertices within 1e-4 of the extent if that closes the surface, divides
/// edges at vertices of other triangles, and fills small holes. Parts that are still open become one convex
/// hull; flat sheets beside solids are left out. Sets `parts` if solids overlap. Returns the assumptions for
/// warnings; each continues a message after the mesh's name. Throws NoVolume.
std::vector<std::string> make_solid(TriangleMesh& mesh);

/// Volume by the divergence theorem; negative if the triangles face inward [m^3].
double signed_volume(const TriangleMesh& mesh);

/// The convex hull of a mesh's vertices, by qhull. Throws NoVolume.
TriangleMesh convex_hull(const TriangleMesh& mesh);

/// The shape's triangles; null if it is no mesh.
inline const TriangleMesh* mesh_of(const PlacedShape& placed) {
  const Mesh* const mesh = std::get_if<Mesh>(&placed.shape);
  return mesh == nullptr ? nullptr : mesh->triangles.get();
}

/// Joins all meshes into one, with a part for each, so that there is one tree to search.
std::vector<PlacedShape> with_meshes_joined(const std::vector<PlacedShape>& shapes);

/// Moments of the solids' union about the origin of the common frame. Shared volume counts once. It is
/// measured along 10 000 lines, and neglected below 0.1 % of the volume.
SolidMoments moments_of(const std::vector<PlacedShape>& shapes);

/// Moments of inertia about the origin of solids of one density with a total mass of `mass` [kg m^2]. Zero if
/// they have no volume. Shared volume counts once if one of them is a mesh, else in each solid: so scenes of
/// boxes and cylinders keep the inertia that they have in old recordings.
Matrix3 inertia_of(const std::vector<PlacedShape>& shapes, double mass);

/// Moments of a closed mesh; volume that parts share counts in each part.
SolidMoments signed_moments(const TriangleMesh& mesh);

/// Moments of the volume that signed_moments() counts too often; zero if it is below 0.1 % of `volume`.
SolidMoments shared_moments(const TriangleMesh& mesh, double volume);

/// A mesh of these triangles, with their vertices only.
TriangleMesh cut_out(const TriangleMesh& mesh, const std::vector<std::array<int, 3>>& triangles);

/// Adds a mesh at a pose in the frame of `all`, without its `parts`.
void append(const TriangleMesh& mesh, const Pose& pose, TriangleMesh& all);

/// True for a triangle that is a point or a line.
inline bool is_degenerate(const std::array<int, 3>& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// Bounding box of triangles or a whole mesh in its frame, and of a shape in the frame of its pose [m].
Eigen::AlignedBox3d box_around(const TriangleMesh& mesh, const std::vector<std::array<int, 3>>& triangles);
inline Eigen::AlignedBox3d box_around(const TriangleMesh& mesh) {
  return box_around(mesh, mesh.triangles);
}
Eigen::AlignedBox3d box_around(const PlacedShape& shape);

/// A shape's surface in the frame of its pose: a mesh as it is, a round shape as facets inside it.
TriangleMesh surface_of(const PlacedShape& shape);

}  // namespace mrhi
