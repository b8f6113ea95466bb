#include "duration_histogram.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

constexpr double kShortest = 10.0;  // [ns]
constexpr double kBinRatio = 1.02;

}  // namespace

void DurationHistogram::add(Nanoseconds duration) {
  const double ratio = std::max(static_cast<double>(duration) / kShortest, 1.0);
  const int bin = static_cast<int>(std::log(ratio) / std::log(kBinRatio));
  ++bins_[static_cast<std::size_t>(std::min(bin, kBins - 1))];
  ++count_;
  max_ = std::max(max_, duration);
}

double DurationHistogram::quantile_us(double q) const {
  const auto wanted = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(count_)));
  std::uint64_t seen = 0;
  for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
    seen += bins_[bin];
    if (seen == 0 || seen < wanted) continue;
    const double middle = kShortest * std::pow(kBinRatio, static_cast<double>(bin) + 0.5);
    return std::min(1e-3 * middle, max_us());
  }
  return 0.0;
}

}  // namespace mrhi
