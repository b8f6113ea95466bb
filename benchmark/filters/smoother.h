#pragma once

#include <Eigen/Core>
#include <vector>

namespace mrhi::filter_benchmark {

/// Paths over time: a row for each frame, three columns for each point.
using Paths = Eigen::MatrixXd;

struct Smoothed {
  Paths positions, velocities;
};

/// Smooths without delay: fits a parabola at every frame to the points within `half_width` seconds, by least
/// squares with tricube weights (Cleveland 1979). The half-power frequency is 0.7 / half_width Hz at any
/// frame rate.
Smoothed smoothed(const std::vector<double>& times, const Paths& paths, double half_width);

}  // namespace mrhi::filter_benchmark
