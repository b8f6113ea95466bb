#pragma once

#include <cstddef>
#include <vector>

namespace mrhi::real_grasps {

/// Value that the share `q` (0..1) of all does not exceed, interpolated between neighbours; 0 of none.
double quantile(std::vector<double> values, double q);

struct Interval {
  double low = 0.0, high = 1.0;
};

/// Wilson's interval of a share seen as `successes` of `trials`, at 95 % confidence.
Interval wilson(std::size_t successes, std::size_t trials);

}  // namespace mrhi::real_grasps
