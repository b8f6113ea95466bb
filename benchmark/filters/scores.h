#pragma once

#include <vector>

#include "mr_hand_interaction/configuration.h"
#include "takes.h"

namespace mrhi::filter_benchmark {

/// Effect of a filter on the takes. Distances are rms of three axes together.
struct Scores {
  double jitter = 0.0;         ///< of still joints: motion faster than 10 Hz [m]
  double moving_jitter = 0.0;  ///< likewise of moving joints; includes the hand's own motion [m]
  double lag = 0.0;            ///< median of moving fingertips [s]
  double lag_p90 = 0.0;        ///< 90th percentile [s]
  double still_error = 0.0;    ///< of still joints, from the reference [m]
  double moving_error = 0.0;   ///< of moving joints, from the reference [m]
  double bone_error = 0.0;     ///< of the lengths of the fingers' bones, from the reference [m]
  std::size_t moves = 0;       ///< number of moves in the lag
};

Scores score(const std::vector<Take>& takes, const FilterConfiguration& filter);

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

/// A hand at rest that sets off: it reaches by 0.3, 0.4 and 0.5 m in 0.5, 0.75 and 1 s, with minimum jerk.
struct Start {
  double lag = 0.0;   ///< largest distance of the filtered hand behind the true one, mean of its joints [m]
  double rest = 0.0;  ///< rms error of a joint on an axis before [m]
};

/// The worst of several seeds, with white noise on each joint and axis [m], at `rate` frames a second.
Start start_of_a_reach(const FilterConfiguration& filter, double noise, double rate);

}  // namespace mrhi::filter_benchmark
