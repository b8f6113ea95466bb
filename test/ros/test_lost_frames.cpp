#include <gtest/gtest.h>

#include "ros/input_statistics.h"

namespace mrhi {
namespace {

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
