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
  bool shares_walls =
      false;  ///< most of a mesh's thin walls lies in those of the other, or coincides with them

  bool is_allowed() const { return depth <= kOverlap && !shares_walls; }
};

/// If a mesh is one of the two, the depth may be less than what they share, but it is above kOverlap whenever
/// they share a ball of this diameter. Within the budget of searches: what it does not suffice for is not
/// found.
Overlap overlap(const Scene& scene, const SceneGeometry& geometry, const std::vector<BodyState>& bodies,
                std::size_t a, std::size_t b, SearchBudget& budget);

/// "'cube' is 0.02 m in 'table'" for the pairs whose overlap is not allowed where they start, the first few
/// of them; empty: none does. Fixtures may overlap each other, and so may bodies of one mechanism.
std::string overlaps_at_start(const Scene& scene);

/// Pairs of bodies of one mechanism that no joint connects directly and whose overlap is not allowed where
/// they start. They do not touch each other. A mechanism is what joints connect; all fixtures, and what
/// joints connect with them, are one. The greater index comes first.
std::vector<std::pair<int, int>> overlaps_in_mechanisms(const Scene& scene);

}  // namespace mrhi
