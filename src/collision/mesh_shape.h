#pragma once

#include "mesh_tree.h"

namespace mrhi {

/// What a MeshCollider holds, for those who ask for a mesh's parts.
struct MeshShape {
  explicit MeshShape(const TriangleMesh& mesh) : surface(mesh), tree(surface) {}

  MeshSurface surface;
  MeshTree tree;
};

}  // namespace mrhi
