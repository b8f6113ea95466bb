#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace mrhi::real_grasps {

/// Value that the share `q` (0..1) of all does not exceed, interpolated between neighbours; 0 of none.
double quantile(std::vector<double> values, double q);

struct Interval {
  double low = 0.0, high = 1.0;
};

/// Wilson's interval of a share seen as `successes` of `trials`, at 95 % confidence.
Interval wilson(std::size_t successes, std::size_t trials);

/// Successes of the trials of one group, such as a recording.
struct Share {
  std::size_t successes = 0, trials = 0;
};

/// Interval of the share of all trials, at 95 % confidence, if trials of one group depend on each other: the
/// bootstrap over groups, and at least Wilson's interval, as the bootstrap of shares near 0 and 1 is too
/// narrow.
Interval grouped(const std::vector<Share>& groups);

}  // namespace mrhi::real_grasps
