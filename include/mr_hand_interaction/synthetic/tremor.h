#pragma once

#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/synthetic/random.h"

namespace mrhi {

/// A hand's, 8 to 12 Hz: a sum of a few waves.
class Tremor {
 public:
  /// `rms` on an axis [m].
  Tremor(double rms, Random& random);
  /// What it moves the hand by [m].
  Vector3 at(double time) const;

 private:
  struct Wave {
    double frequency, phase;
    Vector3 amplitude;
  };
  std::vector<Wave> waves_;
};

}  // namespace mrhi
