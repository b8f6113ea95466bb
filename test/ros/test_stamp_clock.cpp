#include <gtest/gtest.h>

#include "ros/input_log.h"

namespace mrhi {
namespace {

constexpr Nanoseconds kSecond = 1'000'000'000;

TEST(StampClock, before_the_first_frame_the_stamp_is_now) {
  EXPECT_EQ(StampClock().stamp(ros::Time(5, 7)), 5 * kSecond + 7);
}

TEST(StampClock, stamps_of_another_clock_go_on_as_time_passes) {
  StampClock clock;
  clock.take(1000 * kSecond, ros::Time(1700000000, 0));
  EXPECT_EQ(clock.stamp(ros::Time(1700000002, 0)), 1002 * kSecond);
}

TEST(StampClock, the_stamp_does_not_go_back_with_ros_time) {
  StampClock clock;
  clock.take(1000 * kSecond, ros::Time(1000, 0));
  EXPECT_EQ(clock.stamp(ros::Time(10, 0)), 1000 * kSecond);
}

TEST(StampClock, the_simulation_does_not_see_pauses) {
  StampClock clock;
  clock.take(100 * kSecond, ros::Time(100, 0));
  clock.pause(ros::Time(101, 0));
  clock.pause(ros::Time(103, 0));  // again: the first counts
  EXPECT_TRUE(clock.paused());
  clock.take(130 * kSecond, ros::Time(130, 0));
  clock.resume(ros::Time(131, 0));
  EXPECT_FALSE(clock.paused());
  EXPECT_EQ(clock.to_simulation(132 * kSecond), 102 * kSecond);
  EXPECT_EQ(clock.to_stamp(102 * kSecond), 132 * kSecond);
  clock.resume(ros::Time(140, 0));
  EXPECT_EQ(clock.to_simulation(132 * kSecond), 102 * kSecond);
}

TEST(ClockLeaps, one_of_another_time_for_a_moment_is_not_followed) {
  constexpr Nanoseconds kLook = 33'000'000, kFar = 3'000'000'000'000;
  ClockLeaps leaps;
  Nanoseconds now = 1'000'000'000'000;
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(leaps.look(now += kLook));
  EXPECT_TRUE(leaps.look(now + kFar));
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(leaps.look(now += kLook));  // it is back
  EXPECT_TRUE(leaps.look(now + kFar));
}

TEST(ClockLeaps, one_that_is_still_there_is_followed_and_so_is_a_fast_one) {
  constexpr Nanoseconds kLook = 33'000'000, kFar = 3'000'000'000'000;
  ClockLeaps leaps;
  Nanoseconds now = 1'000'000'000'000;
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(leaps.look(now += kLook));
  EXPECT_TRUE(leaps.look(now += kFar));
  EXPECT_FALSE(leaps.look(now));  // a clock that stands
  EXPECT_FALSE(leaps.look(now += kLook));
  EXPECT_TRUE(leaps.look(now += 100 * kLook));  // a bag at a hundred times its speed
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(leaps.look(now += 100 * kLook));
}

}  // namespace
}  // namespace mrhi
