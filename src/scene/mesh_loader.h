#pragma once

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

}  // namespace mrhi
