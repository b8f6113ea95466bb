#pragma once

#include <vector>

#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// The axis-aligned box about a hand.
class HandExtent {
 public:
  explicit HandExtent(const Hand& hand);

  /// True if a sphere about `centre` may be nearer to the hand than 0.
  bool reaches(const Vector3& centre, double radius) const;

 private:
  Vector3 min_, max_;
};

/// Indices, ascending, of all bodies, fixtures too, that may be nearer to the hand than `margin` [m].
std::vector<int> near_bodies(const Hand& hand, const Scene& scene, const std::vector<BodyState>& bodies,
                             double margin);

}  // namespace mrhi
