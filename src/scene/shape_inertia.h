#pragma once

#include <vector>

#include "mr_hand_interaction/scene/shape.h"

namespace mrhi {

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

/// A shape's surface in the frame that it is placed in: a mesh itself, facets within a round shape.
TriangleMesh surface_of(const PlacedShape& shape);

/// Whether closed parts overlap.
bool overlaps_itself(const TriangleMesh& mesh);

}  // namespace mrhi
