#pragma once

#include "mr_hand_interaction/configuration.h"

namespace mrhi::filter_benchmark {

/// A hand at rest that sets off: it reaches by 0.3, 0.4 and 0.5 m in 0.5, 0.75 and 1 s, with minimum jerk.
struct Start {
  double lag = 0.0;   ///< largest distance of the filtered hand behind the true one, mean of its joints [m]
  double rest = 0.0;  ///< rms error of a joint on an axis before [m]
};

/// The worst of several seeds, with white noise on each joint and axis [m], at `rate` frames a second.
Start start_of_a_reach(const FilterConfiguration& filter, double noise, double rate);

}  // namespace mrhi::filter_benchmark
