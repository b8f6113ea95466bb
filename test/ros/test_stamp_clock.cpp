#include <gtest/gtest.h>

#include "ros/stamp_clock.h"

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

}  // namespace
}  // namespace mrhi
