#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "mr_hand_interaction/stamp_check.h"
#include "tracker_frames.h"

namespace mrhi {
namespace {

constexpr Nanoseconds kMillisecond = 1'000'000, kSecond = 1'000'000'000;

Nanoseconds nanoseconds(double seconds) {
  return static_cast<Nanoseconds>(std::llround(seconds * 1e9));
}

class AClockThatSteps : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(By, AClockThatSteps,
                         ::testing::Values(-1e6, -3600.0, -2.0, -0.5, -0.1, 0.15, 0.5, 1.0, 5.0, 3600.0));

/// At rates from 30 to 200 Hz, with receipts that are late by up to 15 ms: stamps go on as receipts do.
TEST_P(AClockThatSteps, CostsOneFrameAndNoTime) {
  for (const double rate : {30.0, 100.0, 200.0}) {
    StampSteps steps;
    std::mt19937 random(3);
    std::uniform_real_distribution<double> late(0.0, std::min(0.015, 0.7 / rate));
    int off = 0, proved = 0;
    for (int i = 0; i < 400; ++i) {
      const double time = i / rate;
      const Nanoseconds own = nanoseconds(2e6 + time + (i >= 200 ? GetParam() : 0.0));
      const auto verdict = steps.take(own, nanoseconds(5000.0 + time + late(random)));
      const double error = to_seconds(verdict.stamp - nanoseconds(2e6 + time));
      proved += verdict.is_step;
      if (std::abs(error) > 0.03) ++off;  // what receipts are late by, twice
    }
    EXPECT_EQ(proved, 1) << rate;
    EXPECT_EQ(off, 1) << rate;
  }
}

TEST(StampSteps, AreNoneOfAStreamThatIsLateJittersRepeatsOrPauses) {
  StampSteps steps;
  std::mt19937 random(4);
  std::uniform_real_distribution<double> number(0.0, 1.0);
  double time = 10.0, received = 10.0;
  for (int i = 0; i < 5000; ++i) {
    const double kind = number(random);
    time += kind < 0.01 ? 3.0 : 0.01;  // also while receipts are late, of a stall from which they catch up
    received = std::max(received + 1e-5, time + 0.02 * number(random));
    if (kind > 0.98) received += 0.3;
    const Nanoseconds stamp = nanoseconds(time);
    const auto verdict = steps.take(stamp, nanoseconds(received));
    EXPECT_FALSE(verdict.is_step || verdict.first_was_off);
    EXPECT_EQ(verdict.stamp, stamp);
    if (kind < 0.5) continue;
    EXPECT_EQ(steps.take(stamp, nanoseconds(received += 1e-4)).stamp, stamp);  // it repeats
  }
}

TEST(StampSteps, OfALoneFrameAreNone) {
  for (const Nanoseconds far : {-5 * kSecond, 5 * kSecond}) {
    StampSteps steps;
    for (int i = 0; i < 100; ++i) {
      const Nanoseconds time = kSecond + i * 10 * kMillisecond, own = time + (i % 20 == 10 ? far : 0);
      EXPECT_EQ(steps.take(own, time).stamp, own);
    }
  }
}

// A simulation that has been reset has no stream, and would start at any stamp.
TEST_P(AClockThatSteps, PassesNoStampThatIsFarFromTheStream) {
  JointsInput input;
  std::vector<std::string> reasons;
  for (int i = 0; i < 150; ++i) {
    const Nanoseconds time = 5000 * kSecond + i * 10 * kMillisecond;
    TrackerFrame frame = frame_of(hand_away(), time + i / 50 * nanoseconds(GetParam()));
    frame.receipt = time;
    const SourceFrame taken = input.take(std::move(frame), [](Nanoseconds) { return Pose(); });
    if (taken.frame) {
      EXPECT_LE(std::abs(taken.frame->stamp - time), StampCheck::kBack) << i;
    } else {
      reasons.push_back(taken.reason);
    }
  }
  const bool is_far = GetParam() > 0.0 || nanoseconds(GetParam()) < -StampCheck::kBack;
  EXPECT_EQ(reasons, std::vector<std::string>(is_far ? 2 : 0, JointsInput::kStray));
}

// Where receipts prove nothing, StampCheck decides.
TEST(StampSteps, LeaveOutOneFrameWhereReceiptsStandStill) {
  JointsInput input;
  int strays = 0;
  for (int i = 0; i < 100; ++i) {
    TrackerFrame frame = frame_of(hand_away(), kSecond + i * 10 * kMillisecond + (i >= 50 ? 5 * kSecond : 0));
    frame.receipt = kSecond;
    strays += input.take(std::move(frame), [](Nanoseconds) { return Pose(); }).reason == JointsInput::kStray;
  }
  EXPECT_EQ(strays, 1);
}

TEST(StampSteps, TellThatTheFirstFrameAloneWasOfAnotherClock) {
  StampSteps steps;
  steps.take(500'000'000 * kSecond, 0);
  int first_off = 0;
  for (int i = 1; i < 20; ++i) {
    const Nanoseconds own = 1000 * kSecond + i * 10 * kMillisecond;
    const auto verdict = steps.take(own, i * 10 * kMillisecond);
    EXPECT_EQ(verdict.stamp, own);
    first_off += verdict.first_was_off;
    EXPECT_FALSE(verdict.is_step);
  }
  EXPECT_EQ(first_off, 1);
}

/// As on a busy machine, where each topic's frames wait for another time. At the step three frames are in
/// parts.
TEST(JointsInput, KeepsTheHandsOfATrackerTogetherWhenItsClockSteps) {
  for (const Nanoseconds step : {-5 * kSecond, -100 * kMillisecond, 300 * kMillisecond, 5 * kSecond}) {
    for (const double rate : {30.0, 60.0, 120.0}) {
      JointsInput input;
      std::mt19937 random(5);
      std::uniform_real_distribution<double> late(0.0, 0.5 / rate);
      int both = 0, stray = 0;
      for (int i = 0; i < 300; ++i) {
        const double time = i / rate;
        for (const Side side : {Side::left, Side::right}) {
          TrackerFrame frame;
          frame.stream = side == Side::left ? "left" : "right";
          frame.side = side;
          frame.joints.stamp = nanoseconds(100.0 + time) + (i < 150 ? 0 : step);
          frame.joints.hands = {adult_hand(side)};
          frame.receipt = nanoseconds(5000.0 + time + late(random));
          const SourceFrame taken = input.take(frame, [](Nanoseconds) { return Pose{}; });
          if (!taken.frame) continue;
          both += taken.frame->hands.size() == 2;
          stray += i > 10 && taken.frame->hands.size() != 2;
        }
      }
      EXPECT_GT(both, 290) << rate << " Hz, step " << step;
      EXPECT_LE(stray, 6) << rate << " Hz, step " << step;
    }
  }
}

TEST(JointsInput, CountsFramesOfTheFasterHandWithoutOneOfTheOther) {
  for (const int rate : {10, 60}) {  // of the left hand; the right one has 60
    JointsInput input;
    std::size_t sent = 0, hands = 0, unpaired = 0;
    for (int i = 0; i < 600; ++i) {
      for (const Side side : {Side::left, Side::right}) {
        if (side == Side::left && i % (60 / rate) != 0) continue;
        TrackerFrame frame = frame_of(hand_away(side), kSecond + i * kSecond / 60);
        frame.stream = side == Side::left ? "left" : "right";
        frame.side = side;
        const SourceFrame taken = input.take(std::move(frame), [](Nanoseconds) { return Pose(); });
        ++sent;
        hands += taken.frame ? taken.frame->hands.size() : 0;
        for (const auto& [kind, what] : taken.corrected) unpaired += kind == JointsInput::kUnpaired;
      }
    }
    if (const auto rest = input.rest()) hands += rest->hands.size();
    EXPECT_EQ(hands + unpaired, sent);
    EXPECT_LE(unpaired, rate == 60 ? 1u : 500u);
  }
}

/// As of a bag that is played in a loop with --clock.
TEST(StampSteps, AreNoneWhereReceiptsGoBackToo) {
  StampSteps steps;
  for (int round = 0; round < 3; ++round) {
    for (int i = 0; i < 100; ++i) {
      const Nanoseconds time = kSecond + i * 10 * kMillisecond;
      const auto verdict = steps.take(time, time);
      EXPECT_EQ(verdict.stamp, time);
      EXPECT_FALSE(verdict.is_step);
    }
  }
}

TEST(StampSteps, NeedAClockThatRuns) {
  StampSteps steps;
  for (int i = 0; i < 100; ++i) {
    const Nanoseconds own = kSecond + i * 10 * kMillisecond + (i >= 50 ? 5 * kSecond : 0);
    EXPECT_EQ(steps.take(own, kSecond).stamp, own);
  }
}

TEST(StampSteps, AtTheEndsOfWhatAStampCanBeDoNoHarm) {
  StampSteps steps;
  const Nanoseconds most = std::numeric_limits<Nanoseconds>::max(), least = -most;
  for (const Nanoseconds stamp :
       {Nanoseconds{0}, most, least, Nanoseconds{1}, most - 1, 4'294'967'295 * kSecond})
    for (const Nanoseconds receipt : {Nanoseconds{0}, most, 4'294'967'295 * kSecond})
      steps.take(stamp, receipt);
}

}  // namespace
}  // namespace mrhi
