#pragma once

#include <vector>

#include "mr_hand_interaction/synthetic/scripted_grasp.h"

namespace mrhi {

/// Postures of a hand round an object from open to pressed deep into it. `depth` is what thumb and fingers
/// together close beyond its surface; each tip has its share of it. Below 0 the tips are off the surface.
class GripPostures {
 public:
  /// `grasp`'s depths are shares: those of its first two contacts make up one. `deepest` > 0 [m].
  GripPostures(const Grasp& grasp, double deepest);

  HandPosture open, near;  ///< near: just off the surface
  double near_depth;       ///< of `near`, below 0 [m]
  /// Between near_depth and the deepest; beyond, at that end.
  HandPosture at(double depth) const;
  double deepest() const { return deepest_; }

 private:
  double deepest_;
  std::vector<HandPosture> pressed_;  ///< evenly spaced from depth 0 to the deepest
};

}  // namespace mrhi
