#pragma once

#include "mr_hand_interaction/scene/shape.h"
#include "rendering/skin.h"

namespace mrhi {

/// The rest hand's skin (skin_distance()) as fine as it is made; `detailed`: with vertices along creases.
TriangleMesh finest_skin(bool detailed);
/// With about as many triangles, small where it bends and where it is looked at; detailed if there are more
/// than kHumanTriangles.
TriangleMesh modelled_skin(std::size_t triangles);

/// A skin of a mesh on the rest hand's surface; `detailed`: with creases.
SkinModel skinned(const TriangleMesh& rest, bool detailed);

constexpr std::size_t kDetailedTriangles = 12000, kHumanTriangles = 1228,
                      kOutlineTriangles = 400;  ///< of what ships

}  // namespace mrhi
