#include "math/minimum_jerk.h"

#include <gtest/gtest.h>

namespace mrhi {
namespace {

TEST(MinimumJerk, goes_from_rest_to_rest_with_its_greatest_speed_in_the_middle) {
  constexpr double kStep = 1e-5;  // central differences: error about 1e-9
  const auto speed = [](double t) {
    return (minimum_jerk(t + kStep) - minimum_jerk(t - kStep)) / (2.0 * kStep);
  };
  EXPECT_EQ(minimum_jerk(0.0), 0.0);
  EXPECT_EQ(minimum_jerk(1.0), 1.0);
  EXPECT_NEAR(speed(0.0), 0.0, 1e-8);
  EXPECT_NEAR(speed(1.0), 0.0, 1e-8);
  EXPECT_NEAR(speed(0.5), 1.875, 1e-8);
}

TEST(MinimumJerk, stays_at_the_ends_outside_its_duration) {
  EXPECT_EQ(minimum_jerk(-1.0), 0.0);
  EXPECT_EQ(minimum_jerk(2.0), 1.0);
}

TEST(MinimumJerk, has_the_velocities_that_were_asked_for_at_its_ends) {
  const Vector3 from(1, 2, 3), to(4, 3, 2), v0(0.5, -1, 0), v1(0, 2, 1);
  const double duration = 0.8, step = 1e-6;
  const auto at = [&](double t) { return minimum_jerk(from, v0, to, v1, duration, t); };
  EXPECT_EQ(at(0.0), from);
  EXPECT_LT((at(1.0) - to).norm(), 1e-12);
  // One-sided differences; the acceleration is zero there, so their error is of second order.
  EXPECT_LT(((at(step) - from) / (step * duration) - v0).norm(), 1e-6);
  EXPECT_LT(((to - at(1.0 - step)) / (step * duration) - v1).norm(), 1e-6);
}

TEST(MinimumJerk, is_straight_and_even_when_the_ends_have_the_mean_velocity) {
  const Vector3 from(0, 0, 0), velocity(0.1, -0.3, 0.2);
  for (const double t : {0.1, 0.35, 0.8}) {
    const Vector3 p = minimum_jerk(from, velocity, 2.0 * velocity, velocity, 2.0, t);
    EXPECT_LT((p - 2.0 * t * velocity).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace mrhi
