#pragma once

#include "mr_hand_interaction/configuration.h"

namespace mrhi::filter_benchmark {

/// How a cube rides in a pinch whose hand sways by 0.1 m and is tracked with noise; the worst of three seeds.
struct Ride {
  double true_slip = 0.0;     ///< where it sits in the hand in the end, from where it sat [m]
  double displacement = 0.0;  ///< in the hand on the way, at most [m]
  double jitter = 0.0;        ///< of the cube, what is faster than 25 ms, rms [m]
};

Ride ride(const FilterConfiguration& filter);

}  // namespace mrhi::filter_benchmark
