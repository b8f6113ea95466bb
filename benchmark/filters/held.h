#pragma once

#include "mr_hand_interaction/configuration.h"

namespace mrhi::filter_benchmark {

/// Motion of a cube in a pinch whose hand sways by 0.1 m and is tracked with noise; worst of three seeds.
struct Ride {
  double true_slip = 0.0;     ///< final displacement in the hand [m]
  double displacement = 0.0;  ///< maximum displacement in the hand [m]
  double jitter = 0.0;        ///< rms of the cube's motion faster than 25 ms [m]
};

Ride ride(const FilterConfiguration& filter);

/// Amplitude that the filter gives a hand shaken by 5 cm at 3 Hz, seen 120 times a second without noise, over
/// the true one.
double gain_of_a_shake(const FilterConfiguration& filter);

}  // namespace mrhi::filter_benchmark
