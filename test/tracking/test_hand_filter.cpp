#include <gtest/gtest.h>

#include "mr_hand_interaction/tracking/hand_filter.h"
#include "support/fixtures.h"

namespace mrhi {
namespace {

Hand hand_at(double x) {
  return testing::finger(Vector3(x, 0, 0), Vector3(x, 0, 0.02), 0.008);
}

SampleHistory history_of(const std::vector<double>& oldest_first, int keep) {
  SampleHistory history;
  for (const double x : oldest_first) history.push(hand_at(x), keep);
  return history;
}

constexpr std::size_t kTip = capsule_index(1, 3);

TEST(WindowFilter, is_the_mean_of_the_last_F_frames_with_gain_one) {
  const FilterConfiguration filter;  // F = 3
  const SampleHistory history = history_of({9.0, 1.0, 2.0, 6.0}, history_length(filter));
  EXPECT_NEAR(filtered(history, filter).capsules[kTip].start.x(), 3.0, 1e-15);
  const SampleHistory still = history_of({0.25, 0.25, 0.25, 0.25}, history_length(filter));
  EXPECT_DOUBLE_EQ(filtered(still, filter).capsules[kTip].start.x(),
                   0.25);  // Eq. 1 as printed would give 1/3
}

TEST(WindowFilter, takes_fewer_frames_at_the_start) {
  const FilterConfiguration filter;
  EXPECT_DOUBLE_EQ(filtered(history_of({1.0}, 3), filter).capsules[kTip].start.x(), 1.0);
  EXPECT_DOUBLE_EQ(filtered(history_of({1.0, 2.0}, 3), filter).capsules[kTip].start.x(), 1.5);
}

TEST(WindowFilter, none_gives_the_newest_sample) {
  FilterConfiguration filter;
  filter.type = FilterKind::none;
  EXPECT_DOUBLE_EQ(filtered(history_of({1.0, 2.0}, history_length(filter)), filter).capsules[kTip].start.x(),
                   2.0);
}

TEST(WindowFilter, orientation_mean_lies_halfway_and_ignores_the_quaternions_sign) {
  FilterConfiguration filter;
  filter.window = 2;
  Hand a = hand_at(0), b = hand_at(0);
  a.palm.orientation = Eigen::AngleAxisd(0.2, Vector3::UnitY());
  b.palm.orientation = Eigen::AngleAxisd(1.0, Vector3::UnitY());
  b.palm.orientation.coeffs() = -b.palm.orientation.coeffs();
  SampleHistory history;
  history.push(a, 2);
  history.push(b, 2);
  const Quaternion expected(Eigen::AngleAxisd(0.6, Vector3::UnitY()));
  EXPECT_LE(filtered(history, filter).palm.orientation.angularDistance(expected), 1e-7);
}

TEST(WindowFilter, a_finger_that_was_missing_is_averaged_from_when_it_is_back) {
  const FilterConfiguration filter;
  Hand without = hand_at(5.0);
  without.capsules[kTip].radius = 0.0;
  SampleHistory history;
  history.push(hand_at(100.0), 3);
  history.push(without, 3);
  history.push(hand_at(1.0), 3);
  EXPECT_DOUBLE_EQ(filtered(history, filter).capsules[kTip].start.x(), 1.0);
  history.push(without, 3);
  EXPECT_FALSE(filtered(history, filter).has(kTip));
}

TEST(WindowFilter, delays_a_steady_motion_by_half_the_window_less_one) {
  const FilterConfiguration filter;
  const SampleHistory history = history_of({0.0, 0.01, 0.02, 0.03}, 3);
  EXPECT_NEAR(filtered(history, filter).capsules[kTip].start.x(), 0.02, 1e-15);  // one frame behind at F = 3
}

}  // namespace
}  // namespace mrhi
