#pragma once

#include <vector>

#include "takes.h"

namespace mrhi::filter_benchmark {

/// What a filter does to the takes. Distances are rms of three axes together.
struct Scores {
  double jitter = 0.0;         ///< of still joints: what is faster than 10 Hz [m]
  double moving_jitter = 0.0;  ///< the same of moving joints; includes what the hand does itself [m]
  double lag = 0.0;            ///< the middle one of moving fingertips' [s]
  double lag_p90 = 0.0;        ///< nine of ten lag at most this [s]
  double still_error = 0.0;    ///< of still joints, from the reference [m]
  double moving_error = 0.0;   ///< of moving joints, from the reference [m]
  double bone_error = 0.0;     ///< of the fingers' bones' lengths, from the reference's [m]
  std::size_t moves = 0;       ///< the lag is of so many
};

Scores score(const std::vector<Take>& takes, const FilterConfiguration& filter);

}  // namespace mrhi::filter_benchmark
