#include <gtest/gtest.h>

#include "mr_hand_interaction/tracking/hand_merger.h"

namespace mrhi {
namespace {

constexpr Nanoseconds kMs = 1'000'000;

HandFrame frame(Side side, Nanoseconds stamp) {
  Hand hand;
  hand.side = side;
  return {stamp, {hand}};
}

/// What comes of two streams with periods and a lag of the right one, in the order of their stamps [ms].
std::vector<HandFrame> paired(double left_period, double right_period, double lag, double end) {
  HandPairs pairs;
  std::vector<HandFrame> frames;
  double left = 0.0, right = lag;
  while (std::min(left, right) < end) {
    const Side side = left <= right ? Side::left : Side::right;
    double& time = side == Side::left ? left : right;
    const auto complete = pairs.take(side, frame(side, static_cast<Nanoseconds>(time * 1e6)));
    if (complete) frames.push_back(*complete);
    time += side == Side::left ? left_period : right_period;
  }
  return frames;
}

/// From the time on when both streams are known, every frame has both hands, left first; they come as often
/// as the slower of them.
void expect_pairs(const std::vector<HandFrame>& frames, double period, double end) {
  std::size_t pairs = 0;
  for (const HandFrame& frame : frames) {
    if (frame.stamp < static_cast<Nanoseconds>(3.0 * period * 1e6)) continue;
    ++pairs;
    ASSERT_EQ(frame.hands.size(), 2u) << frame.stamp;
    EXPECT_EQ(frame.hands[0].side, Side::left);
    EXPECT_EQ(frame.hands[1].side, Side::right);
  }
  EXPECT_GE(static_cast<double>(pairs), end / period - 5.0);
}

TEST(HandPairs, HandsOfTheSameTimeAreOneFrame) {
  for (const double period : {16.7, 110.0, 250.0})
    expect_pairs(paired(period, period, 0.0, 60.0 * period), period, 60.0 * period);
}

TEST(HandPairs, ALagBetweenTheStreamsDoesNotMatter) {
  for (const double lag : {0.1, 3.0, 8.0, 8.4, 12.0, 16.0})
    expect_pairs(paired(16.7, 16.7, lag, 1000.0), 16.7, 1000.0);
}

TEST(HandPairs, TheFasterStreamLosesWhatHasNoPartner) {
  expect_pairs(paired(8.3, 33.2, 0.0, 1000.0), 33.2, 1000.0);
  expect_pairs(paired(33.2, 16.6, 0.0, 1000.0), 33.2, 1000.0);
}

TEST(HandPairs, AStreamAloneWaitsForNobody) {
  HandPairs pairs;
  for (int i = 0; i < 100; ++i) {
    const auto complete = pairs.take(Side::right, frame(Side::right, i * 10 * kMs));
    ASSERT_TRUE(complete);
    EXPECT_EQ(complete->stamp, i * 10 * kMs);
  }
  EXPECT_FALSE(pairs.rest());
}

TEST(HandPairs, AStreamThatEndsIsWaitedForNoLongerThanTwoOfItsIntervals) {
  HandPairs pairs;
  for (int i = 0; i < 10; ++i) {
    pairs.take(Side::left, frame(Side::left, i * 10 * kMs));
    pairs.take(Side::right, frame(Side::right, i * 10 * kMs));
  }
  int without = 0;
  for (int i = 10; i < 20; ++i) without += pairs.take(Side::left, frame(Side::left, i * 10 * kMs)) ? 0 : 1;
  EXPECT_LE(without, 2);
}

TEST(HandPairs, WhatWaitsAtTheEndIsTheRest) {
  HandPairs pairs;
  for (int i = 0; i < 3; ++i) {
    pairs.take(Side::left, frame(Side::left, i * 10 * kMs));
    pairs.take(Side::right, frame(Side::right, i * 10 * kMs));
  }
  EXPECT_FALSE(pairs.take(Side::left, frame(Side::left, 30 * kMs)));
  const auto rest = pairs.rest();
  ASSERT_TRUE(rest);
  EXPECT_EQ(rest->stamp, 30 * kMs);
  EXPECT_FALSE(pairs.rest());
}

// Waiting for the other hand would cost more than is seen of it.
TEST(HandPairs, FramesMoreThanThreeTenthsOfASecondApartWaitForNoPartner) {
  HandPairs pairs;
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(pairs.take(Side::left, frame(Side::left, i * 400 * kMs))) << i;
    EXPECT_TRUE(pairs.take(Side::right, frame(Side::right, i * 400 * kMs + 60 * kMs))) << i;
  }
}

TEST(HandPairs, TimeThatGoesBackBeginsAnew) {
  HandPairs pairs;
  for (int i = 0; i < 10; ++i) {
    pairs.take(Side::left, frame(Side::left, 1000 * kMs + i * 10 * kMs));
    pairs.take(Side::right, frame(Side::right, 1000 * kMs + i * 10 * kMs));
  }
  EXPECT_TRUE(pairs.take(Side::left, frame(Side::left, 0)));
  EXPECT_TRUE(pairs.take(Side::left, frame(Side::left, 10 * kMs)));
}

}  // namespace
}  // namespace mrhi
