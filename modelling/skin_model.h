#pragma once

#include "mr_hand_interaction/scene/shape.h"
#include "rendering/skin.h"

namespace mrhi {

/// The rest hand's skin (skin_distance()) as fine as it is made.
TriangleMesh finest_skin();
/// With about as many triangles, small where it bends and where it is looked at.
TriangleMesh modelled_skin(std::size_t triangles);

/// A skin of a mesh on the rest hand's surface.
SkinModel skinned(const TriangleMesh& rest);

constexpr std::size_t kHumanTriangles = 1200, kOutlineTriangles = 400;  ///< of what ships

}  // namespace mrhi
