#pragma once

#include <vector>

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

}  // namespace mrhi::filter_benchmark
