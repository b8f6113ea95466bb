#pragma once

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

/// The convex hull of a mesh's vertices, by qhull. Throws std::runtime_error, whose text goes on from the
/// mesh's name, if it has no volume.
TriangleMesh convex_hull(const TriangleMesh& mesh);

}  // namespace mrhi
