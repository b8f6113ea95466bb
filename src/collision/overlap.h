#pragma once

#include <string>
#include <utility>
#include <vector>

#include "body_manifold.h"
#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/scene.h"
#include "scene_geometry.h"

namespace mrhi {

/// Largest overlap of two bodies that is allowed at the start, as of bodies at rest on each other [m].
constexpr double kOverlap = 0.001;

/// How far body `a` is in body `b`.
struct Overlap {
  double depth = 0.0;  ///< [m]; 0 if they do not overlap
  Vector3 apart =
      Vector3::Zero();        ///< displacement of `a` that parts them where they are deepest; 0: unknown [m]
  bool shares_walls = false;  ///< of thin walls most lie in the other body, or they cross it

  bool is_allowed() const { return depth <= kOverlap * (1.0 + 1e-6) && !shares_walls; }  // but for rounding
};

/// With a mesh the depth may be less than the overlap, but it is above kOverlap whenever the two share a ball
/// of this diameter, as far as the budget of searches suffices.
Overlap overlap(const Scene& scene, const SceneGeometry& geometry, const std::vector<BodyState>& bodies,
                std::size_t a, std::size_t b, SearchBudget& budget);

/// "'cube' is 0.02 m in 'table'" for the first few pairs whose overlap at the start is not allowed; empty:
/// none. Fixtures may overlap each other, and so may bodies of one mechanism. `searches` of meshes: of all
/// pairs; beyond them each pair has SearchBudget::kMinSample.
std::string overlaps_at_start(const Scene& scene, double searches = 1e300);

/// Moves free bodies apart that overlap where they start: their contact would push them apart and so add
/// energy. Bodies on joints stay. Returns by how far each body was moved [m].
std::vector<double> part_at_start(Scene& scene);

/// Pairs of bodies of one mechanism that no joint connects directly and whose overlap at the start is not
/// allowed: they do not touch each other. A mechanism is all bodies that joints connect; all fixtures belong
/// to one. The greater index comes first.
std::vector<std::pair<int, int>> overlaps_in_mechanisms(const Scene& scene);

}  // namespace mrhi
