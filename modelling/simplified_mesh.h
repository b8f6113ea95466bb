#pragma once

#include <vector>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

using Places = std::vector<Vector3>;  ///< of a mesh's vertices

/// A closed mesh with about `triangles` of its triangles left and closed still: edges collapse onto one of
/// their ends, first those by whose loss the surface moves least (quadric error, Garland & Heckbert 1997) in
/// all poses together (Mohr & Gleicher 2003), so that triangles stay small where the poses bend. `worth` says
/// how much a vertex's moving counts. More triangles are left where every collapse would make a fold.
TriangleMesh simplified(const TriangleMesh& mesh, const std::vector<Places>& poses,
                        const std::vector<double>& worth, std::size_t triangles);

}  // namespace mrhi
