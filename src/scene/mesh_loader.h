#pragma once

#include <string>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// All triangles of an STL, OBJ or DAE file, vertices at the same place joined. A DAE's units are taken, its
/// up axis is not (as in rviz). It is read in a child process with limits on the file's size, time, memory
/// and triangles. Throws std::runtime_error whose text goes on from the file's name.
TriangleMesh load_mesh(const std::string& file, const Vector3& scale);

/// Turns the triangles outward. If the surface is not closed, vertices within 1e-6 of its extent are joined
/// first, which closes the seams that CAD programs leave; if it is open then, std::runtime_error is thrown,
/// as above.
void make_solid(TriangleMesh& mesh);

/// By the divergence theorem; negative if the triangles are turned inward [m^3].
double signed_volume(const TriangleMesh& mesh);

/// The convex hull of a mesh's vertices, by qhull. Throws std::runtime_error, whose text goes on from the
/// mesh's name, if it has no volume.
TriangleMesh convex_hull(const TriangleMesh& mesh);

}  // namespace mrhi
