#include <gtest/gtest.h>

#include "math/duration_histogram.h"

namespace mrhi {
namespace {

constexpr double kRelative = 0.0101;  // half a bin of 2 %

TEST(DurationHistogram, nothing_added_has_quantiles_of_zero) {
  const DurationHistogram histogram;
  EXPECT_EQ(histogram.count(), 0u);
  EXPECT_EQ(histogram.quantile_us(0.5), 0.0);
  EXPECT_EQ(histogram.max_us(), 0.0);
}

TEST(DurationHistogram, quantiles_are_within_one_percent) {
  DurationHistogram histogram;
  for (int microseconds = 1; microseconds <= 1000; ++microseconds) histogram.add(1000 * microseconds);
  EXPECT_NEAR(histogram.quantile_us(0.5), 500.0, kRelative * 500.0);
  EXPECT_NEAR(histogram.quantile_us(0.99), 990.0, kRelative * 990.0);
  EXPECT_NEAR(histogram.quantile_us(1.0), 1000.0, kRelative * 1000.0);
  EXPECT_EQ(histogram.max_us(), 1000.0);
}

TEST(DurationHistogram, no_quantile_exceeds_the_maximum) {
  DurationHistogram histogram;
  histogram.add(12345);
  EXPECT_LE(histogram.quantile_us(0.99), histogram.max_us());
}

TEST(DurationHistogram, extremes_are_counted) {
  DurationHistogram histogram;
  for (const Nanoseconds duration : {Nanoseconds{0}, Nanoseconds{1}, Nanoseconds{3'600'000'000'000}}) {
    histogram.add(duration);
  }
  EXPECT_EQ(histogram.count(), 3u);
  EXPECT_EQ(histogram.max_us(), 3.6e9);
  EXPECT_LT(histogram.quantile_us(0.5), 0.011);
}

}  // namespace
}  // namespace mrhi
