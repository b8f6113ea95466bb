#include "mr_hand_interaction/tracking/hand_merger.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "adult_hand.h"

namespace mrhi {
namespace {

constexpr Nanoseconds kMillisecond = 1'000'000;
constexpr double kSpeed = 0.5;  // of the hands [m/s]

/// A hand that moves along x, seen by a tracker that is off by `error`.
Hand moving(double time, const Vector3& error = Vector3::Zero(), Side side = Side::right,
            std::uint32_t id = 7) {
  const Pose device{Vector3(kSpeed * time, 0.0, 0.2) + error, Quaternion::Identity()};
  Hand hand = complete_hand(adult_hand(side), device);
  hand.id = id;
  return hand;
}

HandFrame frame_at(Nanoseconds stamp, const std::vector<Hand>& hands) {
  return {stamp, hands};
}

/// Streams of other rates, fed in the order of their stamps, each late by nothing.
struct Feed {
  Nanoseconds period, phase;
};

template <class HandsOf>
std::vector<HandFrame> merged(HandMerger& merger, const std::vector<Feed>& feeds, Nanoseconds end,
                              HandsOf hands_of) {
  std::vector<HandFrame> result;
  std::vector<Nanoseconds> next;
  for (const Feed& feed : feeds) next.push_back(feed.phase);
  for (;;) {
    const auto stream = static_cast<std::size_t>(std::min_element(next.begin(), next.end()) - next.begin());
    const Nanoseconds stamp = next[stream];
    if (stamp > end) return result;
    next[stream] += feeds[stream].period;
    const std::optional<std::vector<Hand>> hands = hands_of(stream, stamp);
    if (!hands) continue;
    for (const HandFrame& frame : merger.take(stream, frame_at(stamp, *hands))) result.push_back(frame);
  }
}

TEST(HandMerger, BringsTwoPeoplesHandsTogetherAtTheStampsOfTheFirst) {
  HandMerger merger(2, HandMerger::Mode::people);
  const auto frames = merged(merger, {{9 * kMillisecond, 0}, {16 * kMillisecond, 5 * kMillisecond}},
                             1000 * kMillisecond, [](std::size_t stream, Nanoseconds stamp) {
                               const Vector3 place(0.0, stream == 0 ? 0.0 : 1.0, 0.0);
                               return std::make_optional(std::vector<Hand>{moving(to_seconds(stamp), place)});
                             });
  EXPECT_GT(frames.size(), 105u);
  std::set<std::uint32_t> ids;
  for (const HandFrame& frame : frames) {
    if (frame.stamp < 50 * kMillisecond) continue;
    ASSERT_EQ(frame.hands.size(), 2u);
    for (const Hand& hand : frame.hands) {
      ids.insert(hand.id);
      const double y = hand.palm.position.y() > 0.5 ? 1.0 : 0.0;
      // Interpolated where it moves steadily: exact but for the wrist's rounding to float32.
      const Hand there = moving(to_seconds(frame.stamp), Vector3(0.0, y, 0.0));
      EXPECT_LT((hand.palm.position - there.palm.position).norm(), 1e-9);
      EXPECT_LT((hand.capsules[7].end - there.capsules[7].end).norm(), 1e-9);
    }
  }
  EXPECT_EQ(ids, (std::set<std::uint32_t>{14, 15}));
}

TEST(HandMerger, WaitsForNoStreamThatHasEnded) {
  HandMerger merger(2, HandMerger::Mode::people);
  const auto frames =
      merged(merger, {{10 * kMillisecond, 0}, {10 * kMillisecond, 4 * kMillisecond}}, 2000 * kMillisecond,
             [](std::size_t stream, Nanoseconds stamp) {
               const bool ends = stamp > 1000 * kMillisecond && stream == 0;
               return ends ? std::nullopt : std::make_optional(std::vector<Hand>{moving(to_seconds(stamp))});
             });
  // The second stream leads from when the first has ended, two of its intervals later.
  Nanoseconds last = 0, longest = 0;
  for (const HandFrame& frame : frames) {
    EXPECT_GT(frame.stamp, last - (frame.stamp == 0 ? 1 : 0));
    longest = std::max(longest, frame.stamp - last);
    last = frame.stamp;
  }
  EXPECT_GT(last, 1980 * kMillisecond);
  EXPECT_LE(longest, 40 * kMillisecond);
}

/// Trackers whose calibrations differ by 10 mm; the second is the less sure.
TEST(HandMerger, FusesOnePersonsHandByConfidenceWithoutAJumpWhereATrackerLosesIt) {
  const Vector3 error(0.0, 0.01, 0.0);
  HandMerger merger(2, HandMerger::Mode::fused);
  const auto frames =
      merged(merger, {{10 * kMillisecond, 0}, {12 * kMillisecond, 3 * kMillisecond}}, 3000 * kMillisecond,
             [&](std::size_t stream, Nanoseconds stamp) {
               std::vector<Hand> hands;
               const bool hides = stream == 0 && stamp > 1000 * kMillisecond && stamp < 2000 * kMillisecond;
               if (!hides)
                 hands.push_back(moving(to_seconds(stamp), stream == 0 ? Vector3(Vector3::Zero()) : error,
                                        Side::right, stream == 0 ? 7 : 40));
               for (Hand& hand : hands) hand.confidence = stream == 0 ? 0.9 : 0.3;
               return std::make_optional(hands);
             });
  double largest = 0.0;
  std::optional<HandFrame> before;
  for (const HandFrame& frame : frames) {
    if (frame.stamp < 300 * kMillisecond) continue;
    ASSERT_EQ(frame.hands.size(), 1u) << frame.stamp;
    EXPECT_EQ(frame.hands[0].id, 2u);
    const double off = frame.hands[0].palm.position.y() - moving(to_seconds(frame.stamp)).palm.position.y();
    const bool alone = frame.stamp > 1300 * kMillisecond && frame.stamp < 1900 * kMillisecond;
    const bool both = frame.stamp < 900 * kMillisecond || frame.stamp > 2300 * kMillisecond;
    // By confidence a quarter of the error; all of it where the second tracker is alone.
    if (both || alone) {
      EXPECT_NEAR(off, (alone ? 1.0 : 0.25) * 0.01, 1e-6) << frame.stamp;
    }
    if (before) {
      const double seconds = to_seconds(frame.stamp - before->stamp);
      const Vector3 way = frame.hands[0].palm.position - before->hands[0].palm.position;
      largest = std::max(largest, (way - Vector3(kSpeed * seconds, 0.0, 0.0)).norm());
    }
    before = frame;
  }
  // 7.5 mm fade within 0.2 s: at most 1.875 times their mean speed, over 12 ms.
  EXPECT_LT(largest, 1.05 * 1.875 * 0.0075 * 0.012 / 0.2);
}

TEST(HandMerger, TakesTheSurerOfHandsThatAreFarApart) {
  HandMerger merger(2, HandMerger::Mode::fused);
  Hand here = moving(0.0), there = moving(0.0, Vector3(0.0, 0.5, 0.0));
  here.confidence = 0.4;
  there.confidence = 0.8;
  std::vector<HandFrame> frames;
  for (int i = 0; i < 10; ++i) {
    for (std::size_t stream = 0; stream < 2; ++stream)
      for (const HandFrame& frame :
           merger.take(stream, frame_at(i * 10 * kMillisecond, {stream == 0 ? here : there})))
        frames.push_back(frame);
  }
  ASSERT_GT(frames.size(), 5u);
  EXPECT_LT((frames.back().hands[0].palm.position - there.palm.position).norm(), 1e-9);
}

TEST(HandMerger, NeedsAStream) {
  EXPECT_THROW(HandMerger(0, HandMerger::Mode::people), std::invalid_argument);
}

}  // namespace
}  // namespace mrhi
