#include "collision/step_motion.h"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using mrhi::first_touch;
using mrhi::Separation;

struct Nothing {};
using Now = std::optional<Separation<Nothing>>;

TEST(Sweep, finds_the_first_touch_of_a_distance_that_is_convex_in_time) {
  const auto touch = first_touch<Nothing>(
      [](double t) -> Now {
        return Separation<Nothing>{{}, (t - 0.3) * (t - 0.5), 2.0 * t - 0.8};
      },
      1.0);
  ASSERT_TRUE(touch);
  EXPECT_NEAR(touch->time, 0.3, 1e-5);  // a micrometre away at 0.2 m/s
  EXPECT_LE(touch->time, 0.3);
}

TEST(Sweep, ends_without_a_touch_where_it_parts_is_too_far_or_comes_too_late) {
  const auto touches = [](double distance, double rate, double duration) {
    return first_touch<Nothing>(
               [&](double t) -> Now {
                 if (distance > 1.0) return std::nullopt;
                 return Separation<Nothing>{{}, distance + rate * t, rate};
               },
               duration)
        .has_value();
  };
  EXPECT_TRUE(touches(0.5, -1.0, 0.6));
  EXPECT_FALSE(touches(0.5, -1.0, 0.4));
  EXPECT_FALSE(touches(0.5, 0.0, 1e9));
  EXPECT_FALSE(touches(0.5, 1.0, 1e9));
  EXPECT_FALSE(touches(1.5, -1.0, 1e9));
}

/// Each of Newton's steps leaves a part of the distance: none of them gets there.
TEST(Sweep, gives_up_on_what_comes_nearer_for_ever) {
  int asked = 0;
  const auto touch = first_touch<Nothing>(
      [&](double t) -> Now {
        ++asked;
        return Separation<Nothing>{{}, 1e10 * std::exp(-t), -1e10 * std::exp(-t)};
      },
      1e9);
  EXPECT_FALSE(touch);
  EXPECT_EQ(asked, 30);
}

}  // namespace
