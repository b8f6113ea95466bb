#include <gtest/gtest.h>

#include "support/fixtures.h"
#include "tracking/hand_filter.h"

namespace mrhi {
namespace {

using testing::at;

Hand hand_at(double x, std::uint32_t id = 1, Side side = Side::right) {
  Hand hand = testing::finger(Vector3(x, 0, 0), Vector3(x, 0, 0.02), 0.008);
  hand.id = id;
  hand.side = side;
  return hand;
}

class Tracker : public ::testing::Test {
 protected:
  void frame(double t, std::vector<Hand> seen) {
    events_.clear();
    lose_unseen_hands(at(t), configuration_.tracking.hold_time, hands_, events_);
    track_hands({at(t), std::move(seen)}, t - last_, people_, configuration_, hands_, events_);
    last_ = t;
  }
  int active() const {
    return static_cast<int>(
        std::count_if(hands_.begin(), hands_.end(), [](const HandTrack& t) { return t.active; }));
  }
  double x(std::size_t slot = 0) const {
    return hands_[slot].current.capsules[capsule_index(1, 3)].start.x();
  }

  Configuration configuration_ = testing::unfiltered();
  std::vector<HandTrack> hands_ = std::vector<HandTrack>(kMaxHands);
  std::vector<Event> events_;
  double last_ = -0.01;  // stamp of the frame before [s]
  std::uint32_t people_ = 1;
};

TEST_F(Tracker, a_new_hand_is_found_once) {
  frame(0.00, {hand_at(0)});
  ASSERT_EQ(events_.size(), 1u);
  EXPECT_EQ(events_[0].kind, EventKind::hand_found);
  frame(0.01, {hand_at(0.001)});
  EXPECT_TRUE(events_.empty());
  EXPECT_EQ(active(), 1);
}

TEST_F(Tracker, a_missing_hand_keeps_its_pose_for_hold_time_and_is_lost_then) {
  frame(0.00, {hand_at(0.1)});
  frame(0.10, {});
  EXPECT_EQ(active(), 1);
  EXPECT_TRUE(hands_[0].held);
  EXPECT_DOUBLE_EQ(x(), 0.1);
  frame(0.19, {});
  EXPECT_EQ(active(), 1);
  frame(0.21, {});
  EXPECT_EQ(active(), 0);
  ASSERT_EQ(events_.size(), 1u);
  EXPECT_EQ(events_[0].kind, EventKind::hand_lost);
}

TEST_F(Tracker, a_hand_found_again_under_a_new_id_goes_on_as_the_same_hand) {
  frame(0.00, {hand_at(0.1, 7)});
  frame(0.05, {});
  frame(0.10, {hand_at(0.11, 8)});
  EXPECT_TRUE(events_.empty());
  EXPECT_EQ(active(), 1);
  EXPECT_EQ(hands_[0].current.id, 8u);
}

TEST_F(Tracker, after_a_short_loss_it_catches_up_without_a_snap) {
  frame(0.00, {hand_at(0.10)});
  frame(0.05, {});
  frame(0.15, {hand_at(0.20)});
  EXPECT_DOUBLE_EQ(x(), 0.10);
  frame(0.35, {hand_at(0.20)});
  EXPECT_NEAR(x(), 0.15, 1e-12);
  frame(0.55, {hand_at(0.20)});
  EXPECT_NEAR(x(), 0.20, 1e-12);
}

// Frames without the hand once stopped a hand of 0.75 m/s dead, and it was 9 cm late, for 0.4 s.
TEST_F(Tracker, a_moving_hand_that_is_missing_for_a_moment_moves_on) {
  constexpr double kSpeed = 0.75, kLost = 0.5;
  for (const double rate : {30.0, 60.0, 120.0}) {
    for (const double away : {0.01, 0.04, 0.07}) {
      hands_.assign(kMaxHands, HandTrack());
      last_ = -1.0 / rate;
      double worst = 0.0, slowest = kSpeed, before = 0.0;
      for (int i = 0; i / rate < 1.0; ++i) {
        const double t = i / rate;
        frame(t,
              t <= kLost || t > kLost + away ? std::vector<Hand>{hand_at(kSpeed * t)} : std::vector<Hand>{});
        worst = std::max(worst, std::abs(x() - kSpeed * t));
        if (i > 0) slowest = std::min(slowest, rate * (x() - before));
        before = x();
      }
      // It slows down to half of its speed in 0.07 s: by the integral of (t / 0.1)^2, 8 mm, and in the frame
      // in which it returns.
      const double longest = away + 1.0 / rate;
      EXPECT_LE(worst, kSpeed * std::pow(std::min(longest, 0.1), 3) / 0.03 + 1e-9) << rate << " " << away;
      EXPECT_GE(slowest, 0.3 * kSpeed) << rate << " " << away;
      EXPECT_NEAR(x(), before, 1e-12);
    }
  }
}

// Every second frame without the hand, as from a tracker of half of the rate.
TEST_F(Tracker, a_hand_in_every_second_frame_does_not_lag_behind) {
  constexpr double kSpeed = 0.75;
  for (int i = 0; i < 240; ++i) {
    const double t = i / 120.0;
    frame(t, i % 2 == 0 ? std::vector<Hand>{hand_at(kSpeed * t)} : std::vector<Hand>{});
    if (t > 0.5) {
      EXPECT_NEAR(x(), kSpeed * t, 0.002) << i;
    }
    last_ = t;
  }
}

// Differences of frames of 1/120 s are the mean over two of them: a little below the law's own maximum.
TEST_F(Tracker, a_hand_that_moves_on_is_caught_up_with_by_5_m_per_s2_never_ahead_of_it) {
  constexpr double kFrame = 1.0 / 120.0, kSpeed = 0.24, kLost = 0.5;
  for (const double away : {0.12, 0.15, 0.18}) {
    hands_.assign(kMaxHands, HandTrack());
    std::vector<double> way;
    for (double t = 0.0; t < 1.5; t += kFrame) {
      const bool seen = t < kLost || t >= kLost + away;
      frame(t, seen ? std::vector<Hand>{hand_at(kSpeed * t)} : std::vector<Hand>{});
      EXPECT_LE(x(), kSpeed * t + 1e-12);
      if (t >= kLost + 0.1) way.push_back(x());  // from when it has stopped
    }
    for (std::size_t i = 2; i < way.size(); ++i) {
      const double speed = (way[i] - way[i - 1]) / kFrame, before = (way[i - 1] - way[i - 2]) / kFrame;
      EXPECT_GE(speed, -1e-12);
      EXPECT_LE(std::abs(speed - before) / kFrame, 5.0) << away << " frame " << i;
    }
    EXPECT_NEAR(way.back(), way[way.size() - 2] + kSpeed * kFrame, 1e-9) << away;
    EXPECT_EQ(hands_[0].rejoin.duration, 0) << away;
  }
}

TEST(Rejoin, takes_as_long_as_the_way_needs_within_bounds) {
  EXPECT_EQ(rejoin_duration(0.0, 0.0), at(0.05) - at(0.0));
  EXPECT_EQ(rejoin_duration(0.5, 5.0), at(0.4) - at(0.0));
  EXPECT_GT(rejoin_duration(0.02, 0.1), rejoin_duration(0.01, 0.1));
  EXPECT_GT(rejoin_duration(0.02, 0.2), rejoin_duration(0.02, 0.1));
}

TEST_F(Tracker, filter_starts_afresh_after_a_loss_of_more_than_a_tenth_of_a_second) {
  configuration_.filter.type = FilterKind::window;
  frame(0.00, {hand_at(0.0)});
  frame(0.01, {hand_at(0.0)});
  frame(0.02, {});
  frame(0.05, {hand_at(0.09)});
  EXPECT_EQ(hands_[0].filter.history.size, 3);  // as if no frame had been sent
  frame(0.07, {});
  frame(0.16, {hand_at(0.09)});
  EXPECT_EQ(hands_[0].filter.history.size, 1);
}

/// At 0.5 m/s the mean of ten frames is 4.5 of them behind. Minimum jerk: half of the way at half of 0.2 s.
TEST_F(Tracker, another_filter_takes_over_within_a_fifth_of_a_second) {
  constexpr double kSpeed = 0.5, kInterval = 0.01, kLag = 4.5 * kInterval * kSpeed;
  configuration_.filter.type = FilterKind::window;
  configuration_.filter.window = 10;
  int n = 0;
  const auto behind_after = [&](int frames) {
    for (int i = 0; i < frames; ++i, ++n) frame(n * kInterval, {hand_at(kSpeed * n * kInterval)});
    return kSpeed * (n - 1) * kInterval - x();
  };
  EXPECT_NEAR(behind_after(40), kLag, 1e-12);
  const FilterConfiguration from = configuration_.filter;
  configuration_.filter.type = FilterKind::none;
  change_filter(from, at((n - 1) * kInterval), hands_);
  EXPECT_NEAR(behind_after(5), (1.0 - 0.103515625) * kLag, 1e-12);
  EXPECT_NEAR(behind_after(5), 0.5 * kLag, 1e-12);
  EXPECT_GT(behind_after(9), 1e-6);
  EXPECT_NEAR(behind_after(1), 0.0, 1e-12);
}

TEST_F(Tracker, a_joint_faster_than_max_speed_has_jumped) {
  frame(0.000, {hand_at(0.0)});
  frame(0.008, {hand_at(0.3)});  // 37 m/s
  EXPECT_TRUE(hands_[0].appeared);
  EXPECT_DOUBLE_EQ(hands_[0].previous.capsules[capsule_index(1, 3)].start.x(), 0.3);
  frame(0.016, {hand_at(0.301)});
  EXPECT_FALSE(hands_[0].appeared);
  EXPECT_TRUE(hands_[0].emerged);
  frame(0.024, {hand_at(0.302)});
  EXPECT_FALSE(hands_[0].emerged);
}

TEST_F(Tracker, max_speed_is_the_speed_from_which_on_it_has) {
  const double speed = configuration_.tracking.max_speed;
  frame(0.00, {hand_at(0.0)});
  frame(0.01, {hand_at(0.0099 * speed)});
  EXPECT_FALSE(hands_[0].appeared);
  frame(0.02, {hand_at(0.0099 * speed + 0.0101 * speed)});
  EXPECT_TRUE(hands_[0].appeared);
}

TEST_F(Tracker, a_new_id_within_30_cm_of_a_held_hand_is_that_hand_and_farther_off_another) {
  for (const double way : {0.29, 0.31}) {
    hands_.assign(kMaxHands, HandTrack());
    frame(0.00, {hand_at(0.0, 7)});
    frame(0.05, {});
    frame(0.10, {hand_at(way, 8)});
    EXPECT_EQ(active(), way < 0.3 ? 1 : 2) << way;
  }
}

// In the frames of operators, hands of two people may be in one place.
TEST_F(Tracker, a_hand_never_continues_that_of_another_person) {
  people_ = 2;
  frame(0.00, {hand_at(0.1, 4)});
  frame(0.05, {hand_at(0.1, 5)});
  ASSERT_EQ(events_.size(), 1u);
  EXPECT_EQ(events_[0].kind, EventKind::hand_found);
  EXPECT_EQ(active(), 2);
  EXPECT_TRUE(hands_[0].held);
  EXPECT_EQ(hands_[0].current.id, 4u);
  frame(0.10, {hand_at(0.1, 6), hand_at(0.1, 5)});
  EXPECT_TRUE(events_.empty());
  EXPECT_EQ(hands_[0].current.id, 6u);
}

TEST_F(Tracker, two_hands_keep_their_tracks_when_the_message_swaps_them) {
  frame(0.00, {hand_at(-0.1, 1, Side::left), hand_at(0.1, 2, Side::right)});
  frame(0.01, {hand_at(0.1, 2, Side::right), hand_at(-0.1, 1, Side::left)});
  EXPECT_DOUBLE_EQ(x(0), -0.1);
  EXPECT_DOUBLE_EQ(x(1), 0.1);
  EXPECT_TRUE(events_.empty());
}

TEST_F(Tracker, two_hands_under_one_id_are_told_apart_by_side) {
  frame(0.00, {hand_at(-0.1, 0, Side::left), hand_at(0.1, 0, Side::right)});
  frame(0.01, {hand_at(0.1, 0, Side::right), hand_at(-0.1, 0, Side::left)});
  EXPECT_EQ(active(), 2);
  EXPECT_DOUBLE_EQ(x(0), -0.1);
}

TEST_F(Tracker, hands_beyond_the_slots_are_left_out) {
  std::vector<Hand> many;
  for (std::uint32_t i = 0; i < kMaxHands + 2; ++i) many.push_back(hand_at(0.5 * i, i));
  frame(0.0, many);
  EXPECT_EQ(active(), kMaxHands);
}

TEST_F(Tracker, radius_scale_applies_to_every_capsule) {
  configuration_.hand_radius_scale = 1.5;
  frame(0.0, {hand_at(0.0)});
  EXPECT_DOUBLE_EQ(hands_[0].current.capsules[capsule_index(1, 3)].radius, 0.012);
}

/// A finger of two bones of 40 and 20 mm that bends by `angle` at its root and as much again at its joint.
Hand bent(double angle, const Quaternion& palm = Quaternion::Identity()) {
  Hand hand;
  hand.id = 1;
  hand.palm.orientation = palm;
  const Vector3 root(0.08, 0, 0);
  const auto along = [](double a) -> Vector3 { return Vector3(std::cos(a), 0, -std::sin(a)); };
  const Vector3 joint = root + 0.04 * along(angle), tip = joint + 0.02 * along(2.0 * angle);
  testing::add_finger(hand, capsule_index(1, 1), palm * root, palm * joint, 0.009);
  testing::add_finger(hand, capsule_index(1, 2), palm * joint, palm * tip, 0.009);
  return hand;
}

double angle_between(const Capsule& a, const Capsule& b) {
  return std::acos(std::min(1.0, (a.end - a.start).normalized().dot((b.end - b.start).normalized())));
}

TEST_F(Tracker, joint_speed_limits_the_turn_of_bones_in_the_palm_and_keeps_them_whole) {
  constexpr double kSpeed = 3.0, kFrame = 0.01;
  configuration_.hand_joint_speed = kSpeed;
  frame(0.0, {bent(0.0)});
  Hand last = hands_[0].current;
  for (int i = 1; i <= 80; ++i) {
    frame(i * kFrame, {bent(1.0)});  // bent at once
    const Hand& now = hands_[0].current;
    const Capsule &near = now.capsules[capsule_index(1, 1)], &far = now.capsules[capsule_index(1, 2)];
    EXPECT_NEAR((near.end - near.start).norm(), 0.04, 1e-12);
    EXPECT_NEAR((far.end - far.start).norm(), 0.02, 1e-12);
    EXPECT_NEAR((far.start - near.end).norm(), 0.0, 1e-12);
    for (const int c : {capsule_index(1, 1), capsule_index(1, 2)})
      EXPECT_LE(angle_between(last.capsules[c], now.capsules[c]), kSpeed * kFrame + 1e-6) << i;
    if (i == 20) {
      EXPECT_GT(angle_between(far, bent(1.0).capsules[capsule_index(1, 2)]), 1.0);
    }
    last = now;
  }
  EXPECT_LT((last.capsules[capsule_index(1, 2)].end - bent(1.0).capsules[capsule_index(1, 2)].end).norm(),
            1e-12);
  // The hand as a whole turns as fast as it is tracked.
  const Quaternion turned(Eigen::AngleAxisd(0.8, Vector3::UnitZ()));
  frame(0.81, {bent(1.0, turned)});
  EXPECT_LT((hands_[0].current.capsules[capsule_index(1, 2)].end -
             bent(1.0, turned).capsules[capsule_index(1, 2)].end)
                .norm(),
            1e-9);
}

// Two joints reported at one place: the bone between them has no direction to turn from.
TEST_F(Tracker, a_bone_that_had_no_length_is_at_once_as_it_is_tracked) {
  configuration_.hand_joint_speed = 3.0;
  const int near = capsule_index(1, 1), far = capsule_index(1, 2);
  Hand stub = bent(1.0);
  stub.capsules[near].end = stub.capsules[far].start = stub.capsules[near].start;
  frame(0.0, {stub});
  frame(0.01, {bent(1.0)});
  EXPECT_LT((hands_[0].current.capsules[near].end - bent(1.0).capsules[near].end).norm(), 1e-12);
}

}  // namespace
}  // namespace mrhi
