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

/// Recordings are split in two, once and for all, so that a model that was tuned on one half can be told by
/// the other: those known by lists, others by their names. All windows of one ARCTIC capture are in one half.
enum class Half { tuned, held_out };

Half half_of(const std::string& name);

/// A window's name without the frame at its end: the capture's.
std::string capture_of(const std::string& window);

}  // namespace mrhi::real_grasps
