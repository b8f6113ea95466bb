#pragma once

#include <array>
#include <cstdint>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Quantiles of any number of durations in constant memory, each within 1 % (bins of 2 %, 10 ns to 20 s).
class DurationHistogram {
 public:
  void add(Nanoseconds duration);
  void clear() { *this = DurationHistogram(); }

  std::uint64_t count() const { return count_; }
  /// Duration that the share `q` (0..1) of all does not exceed [us]; 0 if there are none.
  double quantile_us(double q) const;
  double max_us() const { return 1e-3 * static_cast<double>(max_); }

 private:
  static constexpr int kBins = 1083;
  std::array<std::uint32_t, kBins> bins_{};
  std::uint64_t count_ = 0;
  Nanoseconds max_ = 0;
};

}  // namespace mrhi
