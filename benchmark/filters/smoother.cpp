#include "takes.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace mrhi::filter_benchmark {
namespace {

constexpr int kFewest = 4;  // minimum frames for a parabola

/// Frames from `first` to before `last`.
struct Window {
  std::size_t first, last;
};

Window window_about(const std::vector<double>& times, std::size_t frame, double half_width) {
  const auto from = std::lower_bound(times.begin(), times.end(), times[frame] - half_width);
  const auto to = std::upper_bound(times.begin(), times.end(), times[frame] + half_width);
  Window window{static_cast<std::size_t>(from - times.begin()), static_cast<std::size_t>(to - times.begin())};
  while (window.last - window.first < kFewest && window.last - window.first < times.size()) {
    if (window.first > 0) --window.first;
    if (window.last < times.size()) ++window.last;
  }
  return window;
}

double tricube(double u) {
  const double left = 1.0 - std::abs(u * u * u);
  return left * left * left;
}

}  // namespace

Smoothed smoothed(const std::vector<double>& times, const Paths& paths, double half_width) {
  Smoothed result{Paths(paths.rows(), paths.cols()), Paths(paths.rows(), paths.cols())};
  for (std::size_t frame = 0; frame < times.size(); ++frame) {
    const Window window = window_about(times, frame, half_width);
    const auto size = static_cast<Eigen::Index>(window.last - window.first);
    const double farthest =
        std::max(times[frame] - times[window.first], times[window.last - 1] - times[frame]);
    const double width = std::max(half_width, 1.01 * farthest);
    Eigen::MatrixXd weighted(size, 3), powers(size, 3);
    for (Eigen::Index i = 0; i < size; ++i) {
      const double u = times[window.first + static_cast<std::size_t>(i)] - times[frame];
      powers.row(i) << 1.0, u, u * u;
      weighted.row(i) = tricube(u / width) * powers.row(i);
    }
    const Eigen::Matrix3d normal = weighted.transpose() * powers;
    const Eigen::MatrixXd weights = normal.inverse() * weighted.transpose();
    const auto part = paths.middleRows(static_cast<Eigen::Index>(window.first), size);
    const auto row = static_cast<Eigen::Index>(frame);
    result.positions.row(row) = weights.row(0) * part;
    result.velocities.row(row) = weights.row(1) * part;
  }
  return result;
}

}  // namespace mrhi::filter_benchmark
