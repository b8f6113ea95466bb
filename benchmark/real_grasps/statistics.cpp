#include "statistics.h"

#include <algorithm>
#include <cmath>

namespace mrhi::real_grasps {

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double place = q * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const double above = values[std::min(below + 1, values.size() - 1)];
  return values[below] + (place - std::floor(place)) * (above - values[below]);
}

Interval wilson(std::size_t successes, std::size_t trials) {
  if (trials == 0) return {};
  constexpr double z = 1.959964;  // 97.5 % of a normal distribution lie below
  const double n = static_cast<double>(trials), p = static_cast<double>(successes) / n;
  const double middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  return {successes > 0 ? middle - half : 0.0, successes < trials ? middle + half : 1.0};
}

}  // namespace mrhi::real_grasps
