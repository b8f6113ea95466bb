#include <gtest/gtest.h>

#include "ros/input_log.h"
#include "ros/input_statistics.h"

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

TEST(LostFrames, gaps_in_a_publisher_s_numbers_are_counted) {
  SequenceWatch watch;
  EXPECT_EQ(watch.missing("driver", 1000), 0u);
  EXPECT_EQ(watch.missing("driver", 1001), 0u);
  EXPECT_EQ(watch.missing("driver", 1005), 3u);
  EXPECT_EQ(watch.missing("driver", 1006), 0u);
}

TEST(LostFrames, each_publisher_has_numbers_of_its_own) {
  SequenceWatch watch;
  watch.missing("one", 5);
  EXPECT_EQ(watch.missing("other", 90), 0u);
  EXPECT_EQ(watch.missing("one", 6), 0u);
  EXPECT_EQ(watch.missing("other", 92), 1u);
}

TEST(LostFrames, numbers_that_repeat_or_begin_anew_are_no_loss) {
  SequenceWatch watch;
  watch.missing("driver", 7);
  EXPECT_EQ(watch.missing("driver", 7), 0u) << "who does not count";
  EXPECT_EQ(watch.missing("driver", 0), 0u) << "started again";
  EXPECT_EQ(watch.missing("driver", 2), 1u);
  watch.missing("driver", 4294967295u);
  EXPECT_EQ(watch.missing("driver", 0), 0u) << "the numbers come round";
}

std::string value_of(const diagnostic_updater::DiagnosticStatusWrapper& status, const std::string& key) {
  for (const auto& pair : status.values)
    if (pair.key == key) return pair.value;
  return "";
}

TEST(LostFrames, are_told_once_as_a_warning_and_counted_for_good) {
  using diagnostic_msgs::DiagnosticStatus;
  InputStatistics statistics({});
  statistics.taken(0.001);
  statistics.lost(3);
  statistics.waited(0.2);
  statistics.waited(0.001);
  diagnostic_updater::DiagnosticStatusWrapper first, second;
  statistics.report(first);
  EXPECT_EQ(first.level, DiagnosticStatus::WARN);
  EXPECT_NE(first.message.find("3 frames have not arrived"), std::string::npos);
  statistics.report(second);
  EXPECT_EQ(second.level, DiagnosticStatus::OK);
  EXPECT_EQ(value_of(second, "frames lost by queue"), "3");
  EXPECT_EQ(value_of(second, "frames late by more than 50 ms"), "1");
}

}  // namespace
}  // namespace mrhi
