#pragma once

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Quantiles of any number of durations in constant memory, each within 1 % (bins of 2 %, 10 ns to 20 s).
class DurationHistogram {
 public:
  void add(Nanoseconds duration) {
    const double ratio = std::max(static_cast<double>(duration) / kShortest, 1.0);
    const int bin = static_cast<int>(std::log(ratio) / std::log(kBinRatio));
    ++bins_[std::min(bin, kBins - 1)];
    ++count_;
    max_ = std::max(max_, duration);
  }
  /// Adds the duration of `work`, unless that returns false. Returns what it does.
  template <class Work>
  bool measure(const Work& work) {
    const auto begin = std::chrono::steady_clock::now();
    if (!work()) return false;
    const auto time = std::chrono::steady_clock::now() - begin;
    add(std::chrono::duration_cast<std::chrono::nanoseconds>(time).count());
    return true;
  }
  void clear() { *this = DurationHistogram(); }

  std::uint64_t count() const { return count_; }
  /// Quantile `q` (0..1) of the durations [us]; 0 if there are none.
  double quantile_us(double q) const {
    const auto rank = static_cast<std::uint64_t>(std::ceil(q * static_cast<double>(count_)));
    std::uint64_t seen = 0;
    for (std::size_t bin = 0; bin < bins_.size(); ++bin) {
      seen += bins_[bin];
      if (seen == 0 || seen < rank) continue;
      const double middle = kShortest * std::pow(kBinRatio, static_cast<double>(bin) + 0.5);
      return std::min(1e-3 * middle, max_us());
    }
    return 0.0;
  }
  double max_us() const { return 1e-3 * static_cast<double>(max_); }

 private:
  static constexpr double kShortest = 10.0;  // [ns]
  static constexpr double kBinRatio = 1.02;
  static constexpr int kBins = 1083;
  std::array<std::uint32_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  Nanoseconds max_ = 0;
};

}  // namespace mrhi
