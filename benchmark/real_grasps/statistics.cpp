#include "statistics.h"

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/synthetic/random.h"

namespace mrhi::real_grasps {
namespace {

constexpr int kResamples = 2000;

double ratio(std::size_t successes, std::size_t trials) {
  return static_cast<double>(successes) / static_cast<double>(trials);
}

}  // namespace

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
  constexpr double z = 1.959964;  // 97.5th percentile of a normal distribution
  const double n = static_cast<double>(trials), p = ratio(successes, trials);
  const double middle = (p + z * z / (2.0 * n)) / (1.0 + z * z / n);
  const double half = z / (1.0 + z * z / n) * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
  return {successes > 0 ? middle - half : 0.0, successes < trials ? middle + half : 1.0};
}

Interval grouped(const std::vector<SuccessCount>& groups) {
  SuccessCount all;
  for (const SuccessCount& group : groups) all.successes += group.successes, all.trials += group.trials;
  Interval interval = wilson(all.successes, all.trials);
  if (all.trials == 0) return interval;
  const Interval resampled = bootstrapped(groups);
  return {std::min(interval.low, resampled.low), std::max(interval.high, resampled.high)};
}

// Efron & Tibshirani 1993, chapter 8: resample independent units, the groups.
Interval bootstrapped(const std::vector<SuccessCount>& groups, const std::vector<SuccessCount>& baseline) {
  Random random(1);
  std::vector<double> ratios;
  for (int i = 0; i < kResamples; ++i) {
    SuccessCount sum, of_baseline;
    for (std::size_t k = 0; k < groups.size(); ++k) {
      const std::size_t drawn = random.bits() % groups.size();
      sum.successes += groups[drawn].successes, sum.trials += groups[drawn].trials;
      if (baseline.empty()) continue;
      of_baseline.successes += baseline[drawn].successes, of_baseline.trials += baseline[drawn].trials;
    }
    if (sum.trials == 0 || (!baseline.empty() && of_baseline.trials == 0)) continue;
    ratios.push_back(ratio(sum.successes, sum.trials) -
                     (baseline.empty() ? 0.0 : ratio(of_baseline.successes, of_baseline.trials)));
  }
  if (ratios.empty()) return {};
  return {quantile(ratios, 0.025), quantile(ratios, 0.975)};
}

}  // namespace mrhi::real_grasps
