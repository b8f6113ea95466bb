#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace mrhi::real_grasps {

/// Quantile `q` (0..1), interpolated between neighbours; 0 without values.
double quantile(std::vector<double> values, double q);

struct Interval {
  double low = 0.0, high = 1.0;
};

/// Wilson's interval of a ratio of `successes` to `trials`, at 95 % confidence.
Interval wilson(std::size_t successes, std::size_t trials);

/// Successes of the trials of one group, such as a recording.
struct SuccessCount {
  std::size_t successes = 0, trials = 0;
};

/// Interval of the ratio over all groups, at 95 % confidence, if trials in a group depend on each other: the
/// bootstrap over groups, and at least Wilson's interval, as the bootstrap is too narrow for ratios near 0
/// and 1.
Interval grouped(const std::vector<SuccessCount>& groups);

/// The bootstrap over groups alone, for trials as dependent as the frames of a recording. With `baseline`, of
/// the difference between the ratios of two sets of trials in the same groups.
Interval bootstrapped(const std::vector<SuccessCount>& groups,
                      const std::vector<SuccessCount>& baseline = {});

}  // namespace mrhi::real_grasps
