#pragma once

#include <Eigen/Core>
#include <vector>

namespace mrhi::filter_benchmark {

/// Paths over time: a row per frame, three columns per point.
using Paths = Eigen::MatrixXd;

struct Smoothed {
  Paths positions, velocities;
};

/// Smooths without delay: at every frame a parabola is fitted to what lies within `half_width` seconds before
/// and after, by least squares with tricube weights (Cleveland 1979). Half the power is left at 0.7 /
/// half_width Hz, whatever the frame rate.
Smoothed smoothed(const std::vector<double>& times, const Paths& paths, double half_width);

}  // namespace mrhi::filter_benchmark
