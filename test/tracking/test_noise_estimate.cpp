#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "math/minimum_jerk.h"
#include "mr_hand_interaction/simulation_state.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "mr_hand_interaction/tracking/hand_skeleton.h"
#include "support/fixtures.h"
#include "support/white_noise.h"
#include "tracking/hand_filter.h"

namespace mrhi {
namespace {

using testing::JointNoise;

constexpr std::size_t kIndexTip = capsule_index(1, 3);

/// A whole hand, open and at rest.
HandJoints open_hand() {
  static const HandJoints hand =
      sample(make_motion("grasp_cube"), Side::right, 1'000'000'000, default_device_mount()).hands.at(0);
  return hand;
}

Hand in_world(const HandJoints& joints) {
  return complete_hand(joints, Pose{});
}

HandJoints moved(HandJoints hand, const Vector3& by) {
  for (auto& finger : hand.joints)
    for (auto& joint : finger)
      if (joint) *joint += by;
  if (hand.palm_centre) *hand.palm_centre += by;
  if (hand.wrist) *hand.wrist += by;
  return hand;
}

/// A hand's frames through the default filter.
class Stream {
 public:
  explicit Stream(double rate) : interval_(1.0 / rate) {}

  void take(const HandJoints& joints, double intervals = 1.0) {
    filtered_ = filtered(in_world(joints), intervals * interval_, FilterConfiguration(), memory_);
  }
  /// rms on an axis [m] that a tracker at rest is seen to have, over so many frames.
  double seen(JointNoise noise, int frames) {
    double sum = 0.0;
    for (int i = 0; i < frames; ++i) {
      HandJoints hand = open_hand();
      noise.apply(hand);
      take(hand);
      sum += memory_.noise.variance / frames;
    }
    return std::sqrt(sum);
  }
  double seen() const { return std::sqrt(memory_.noise.variance); }
  const Hand& hand() const { return filtered_; }

 private:
  double interval_;
  FilterMemory memory_;
  Hand filtered_;
};

struct Tremble {
  double noise, rate;  // [m], [1/s]
};

class NoiseEstimate : public ::testing::TestWithParam<Tremble> {};

// A variance is told from 16 frames to 12 %; over 300 frames that is 3 %, and half as much of the rms.
TEST_P(NoiseEstimate, is_the_trackers_whatever_its_rate) {
  Stream stream(GetParam().rate);
  stream.seen({GetParam().noise, 1}, 30);
  EXPECT_NEAR(stream.seen({GetParam().noise, 2}, 300), GetParam().noise, 0.05 * GetParam().noise);
}

// The motion has jerks of its own, which are next to nothing beside a millimetre.
TEST_P(NoiseEstimate, is_the_same_of_a_hand_that_reaches_and_closes) {
  const ScriptedMotion motion = make_motion("grasp_cube");
  Stream stream(GetParam().rate);
  JointNoise noise(GetParam().noise, 3);
  double sum = 0.0;
  int count = 0;
  for (double t = 0.0; t < motion.run_time(); t += 1.0 / GetParam().rate) {
    HandJoints hand = sample(motion, Side::right, testing::at(t) - testing::kStart, Pose{}).hands.at(0);
    noise.apply(hand);
    stream.take(hand);
    if (t < 1.0) continue;
    sum += stream.seen() * stream.seen();
    ++count;
  }
  EXPECT_NEAR(std::sqrt(sum / count), GetParam().noise, 0.1 * GetParam().noise);
}

TEST_P(NoiseEstimate, is_learned_and_forgotten_within_twenty_frames) {
  Stream stream(GetParam().rate);
  stream.seen({0.0001, 1}, 100);
  EXPECT_LE(stream.seen(), 0.0002);
  stream.seen({GetParam().noise, 2}, 20);
  EXPECT_GE(stream.seen(), 0.7 * GetParam().noise);
  stream.seen({0.0001, 3}, 20);
  EXPECT_LE(stream.seen(), 0.0002);
}

TEST_P(NoiseEstimate, does_not_mind_frames_that_are_dropped) {
  Stream stream(GetParam().rate);
  JointNoise noise(GetParam().noise, 4);
  Random drop(5);
  double intervals = 1.0, sum = 0.0;
  int count = 0;
  for (int i = 0; i < 600; ++i, intervals += 1.0) {
    HandJoints hand = open_hand();
    noise.apply(hand);
    if (drop.uniform() < 0.3) continue;
    stream.take(hand, intervals);
    intervals = 0.0;
    if (i < 50) continue;
    sum += stream.seen() * stream.seen();
    ++count;
  }
  EXPECT_NEAR(std::sqrt(sum / count), GetParam().noise, 0.1 * GetParam().noise);
}

INSTANTIATE_TEST_SUITE_P(trackers, NoiseEstimate,
                         ::testing::Values(Tremble{0.001, 30}, Tremble{0.001, 120}, Tremble{0.003, 60},
                                           Tremble{0.005, 30}, Tremble{0.005, 120}));

// Less is seen of coloured noise, in theory sqrt(0.354) at half: its third differences are smaller.
TEST(SeenNoise, of_coloured_noise_is_what_is_white_in_it) {
  Stream stream(60.0);
  stream.seen({0.004, 1, 0.5}, 30);
  EXPECT_NEAR(stream.seen({0.004, 2, 0.5}, 600), std::sqrt(0.354) * 0.004, 0.0003);
}

/// Whether a hand without noise is filtered, bit by bit, as with a good tracker's noise.
template <typename HandAt>
::testing::AssertionResult is_taken_for_clean(double rate, double duration, HandAt hand_at) {
  FilterConfiguration usual;
  usual.noise = kUsualNoise;
  FilterMemory estimated, fixed;
  for (int i = 0; i < duration * rate; ++i) {
    const Hand hand = in_world(hand_at(i / rate));
    const Hand a = filtered(hand, 1.0 / rate, FilterConfiguration(), estimated);
    const Hand b = filtered(hand, 1.0 / rate, usual, fixed);
    if (a.capsules[kIndexTip].end != b.capsules[kIndexTip].end)
      return ::testing::AssertionFailure()
             << "at " << i / rate << " s noise of " << std::sqrt(estimated.noise.variance) << " m is seen";
  }
  return ::testing::AssertionSuccess();
}

class CleanHand : public ::testing::TestWithParam<double> {};

TEST_P(CleanHand, that_slaps_at_three_metres_a_second_is_not_taken_for_noisy) {
  constexpr double kWay = 0.6, kDuration = 1.875 * kWay / 3.0;  // minimum jerk: at most 1.875 way / duration
  EXPECT_TRUE(is_taken_for_clean(GetParam(), 2.0, [](double t) {
    const double there = minimum_jerk(std::clamp((t - 0.5) / kDuration, 0.0, 1.0));
    const double back = minimum_jerk(std::clamp((t - 1.2) / kDuration, 0.0, 1.0));
    return moved(open_hand(), Vector3(kWay * (there - back), 0, 0));
  }));
}

TEST_P(CleanHand, that_opens_and_closes_as_fast_as_it_can_is_not_taken_for_noisy) {
  const ScriptedMotion motion = make_motion("grasp_cube");
  const HandPosture open = motion.keyframes.at(1).posture, fist = 1.5 * motion.keyframes.at(4).posture;
  EXPECT_TRUE(is_taken_for_clean(GetParam(), 3.0, [&](double t) {
    const double share = 0.5 - 0.5 * std::cos(2.0 * M_PI * 3.0 * t);  // three times a second
    return hand_joints(human_hand(), Side::right, Pose{}, open + share * (fist - open));
  }));
}

TEST_P(CleanHand, that_jumps_or_loses_a_finger_for_a_frame_is_not_taken_for_noisy) {
  EXPECT_TRUE(is_taken_for_clean(GetParam(), 2.0, [](double t) {
    HandJoints hand = moved(open_hand(), Vector3(t < 1.0 ? 0.0 : 0.04, 0, 0));
    if (std::abs(t - 1.5) < 0.01) hand.joints[1][4].reset();
    return hand;
  }));
}

TEST_P(CleanHand, one_finger_of_which_leaps_about_is_not_taken_for_noisy) {
  Random random(1);
  EXPECT_TRUE(is_taken_for_clean(GetParam(), 2.0, [&](double) {
    HandJoints hand = open_hand();
    for (auto& joint : hand.joints[4])
      if (joint) *joint += random.gaussian_vector(0.01);
    return hand;
  }));
}

INSTANTIATE_TEST_SUITE_P(rates, CleanHand, ::testing::Values(30.0, 60.0, 120.0));

/// Two hands, one of them through a bad tracker, as the tracker stage follows them.
class TwoTrackers : public ::testing::Test {
 protected:
  static constexpr double kRate = 60.0;

  /// `seen` in each of so many frames; a right hand trembles by 3 mm.
  void frames(int count, const std::vector<Side>& seen) {
    for (int i = 0; i < count; ++i, ++frame_) {
      const Nanoseconds stamp = testing::at(frame_ / kRate);
      HandFrame frame{stamp, {}};
      for (const Side side : seen) {
        HandJoints joints = moved(open_hand(), Vector3(side == Side::right ? 0.0 : 0.5, 0, 0));
        if (side == Side::right) noise_.apply(joints);
        joints.side = side;
        joints.id = ids_ + (side == Side::right ? 1 : 2);
        frame.hands.push_back(in_world(joints));
      }
      lose_unseen_hands(stamp, configuration_.tracking.hold_time, hands_, events_);
      track_hands(frame, 1.0 / kRate, 1, configuration_, hands_, events_);
    }
  }
  void others_come() { ids_ += 2; }
  double seen(Side side) const {
    for (const HandTrack& track : hands_) {
      if (track.active && track.current.side == side) return std::sqrt(track.filter.noise.variance);
    }
    return -1.0;
  }

  Configuration configuration_;
  std::vector<HandTrack> hands_ = std::vector<HandTrack>(kMaxHands);

 private:
  int frame_ = 0;
  std::uint32_t ids_ = 0;
  JointNoise noise_{0.003, 1};
  std::vector<Event> events_;
};

TEST_F(TwoTrackers, have_each_their_own_noise) {
  frames(60, {Side::right, Side::left});
  EXPECT_NEAR(seen(Side::right), 0.003, 0.001);
  EXPECT_LE(seen(Side::left), 1e-6);
}

TEST_F(TwoTrackers, give_a_hand_that_comes_back_what_was_known_of_its_side) {
  frames(60, {Side::right, Side::left});
  const double before = seen(Side::right);
  frames(60, {});
  others_come();
  frames(1, {Side::left, Side::right});
  EXPECT_EQ(seen(Side::right), before);
  EXPECT_LE(seen(Side::left), 1e-6);
}

TEST_F(TwoTrackers, give_a_hand_of_the_other_side_nothing_of_it) {
  frames(60, {Side::right});
  frames(60, {});
  others_come();
  frames(1, {Side::left});
  EXPECT_EQ(seen(Side::left), 0.0);
  frames(59, {Side::left});
  frames(1, {Side::left, Side::right});
  EXPECT_NEAR(seen(Side::right), 0.003, 0.001) << "and keep it for the one whose it is";
}

TEST_F(TwoTrackers, keep_it_through_a_short_loss) {
  frames(60, {Side::right});
  const double before = seen(Side::right);
  frames(static_cast<int>(0.15 * kRate), {});
  frames(2, {Side::right});
  EXPECT_EQ(seen(Side::right), before);
}

// A hand that is gone leaves nothing else behind, and the next one of its side is filtered by it.
TEST_F(TwoTrackers, have_what_they_know_of_a_hand_that_is_gone_in_the_states_hash) {
  frames(60, {Side::right});
  frames(60, {});
  SimulationState one, other;
  one.hands = other.hands = hands_;
  EXPECT_EQ(hash(one), hash(other));
  other.hands[0].filter.noise.variances[3] *= 2.0;
  EXPECT_NE(hash(one), hash(other));
  other.hands[0].filter.noise = SeenNoise();
  EXPECT_NE(hash(one), hash(other));
}

TEST(SeenNoise, is_not_asked_for_where_the_noise_is_given) {
  FilterConfiguration given;
  given.noise = 0.002;
  FilterMemory memory;
  JointNoise noise(0.005, 1);
  for (int i = 0; i < 60; ++i) {
    HandJoints hand = open_hand();
    noise.apply(hand);
    filtered(in_world(hand), 1.0 / 60.0, given, memory);
  }
  EXPECT_EQ(memory.noise.size, 0);
}

/// Error of a filtered fingertip at rest, rms on an axis [m], between two frames after the hand appears. The
/// tracker has noise of 5 mm.
double error_at_rest(const FilterConfiguration& filter, double rate, int first, int last,
                     std::uint32_t seed = 1) {
  const Vector3 place = in_world(open_hand()).capsules[kIndexTip].end;
  FilterMemory memory;
  JointNoise noise(0.005, seed);
  double squares = 0.0;
  for (int i = 0; i < last; ++i) {
    HandJoints hand = open_hand();
    noise.apply(hand);
    const Hand steady = filtered(in_world(hand), 1.0 / rate, filter, memory);
    if (i >= first) squares += (steady.capsules[kIndexTip].end - place).squaredNorm() / 3.0;
  }
  return std::sqrt(squares / (last - first));
}

// docs/pipeline.md: up to 1 mm nothing is made of it.
TEST(FilterNoise, is_the_usual_up_to_a_millimetre_and_beyond_it_what_is_seen) {
  const auto of = [](double rms) {
    SeenNoise seen;
    seen.variance = rms * rms;
    return filter_noise(seen);
  };
  EXPECT_EQ(of(0.0), kUsualNoise);
  EXPECT_EQ(of(0.00099), kUsualNoise);
  EXPECT_NEAR(of(0.002), std::sqrt(0.0004 * 0.0004 + 0.002 * 0.002 - 0.001 * 0.001), 1e-15);
}

TEST(DefaultFilter, lets_through_less_than_half_of_a_bad_trackers_noise_that_it_did_without_knowing_it) {
  FilterConfiguration usual;
  usual.noise = kUsualNoise;
  EXPECT_LE(error_at_rest(FilterConfiguration(), 30.0, 60, 360), 0.5 * error_at_rest(usual, 30.0, 60, 360));
}

// Until the noise is known the filter takes its first samples for exact, and their noise for motion.
TEST(DefaultFilter, soon_follows_a_hand_that_appears_in_noise_as_well_as_one_that_it_knows) {
  for (const double rate : {30.0, 60.0, 120.0}) {
    double soon = 0.0, later = 0.0;
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
      const int known = 10;  // samples: five for the first variance, five variances for the estimate
      soon += error_at_rest(FilterConfiguration(), rate, 2 * known, 4 * known, seed);
      later += error_at_rest(FilterConfiguration(), rate, 100, 400, seed);
    }
    EXPECT_LT(soon, 1.5 * later) << rate;
  }
}

/// Largest distance by which the filtered joints, on average, are behind a hand that reaches by 0.4 m in
/// 0.75 s from rest [m].
double lag_at_a_start(const FilterConfiguration& filter, double rate, double noise) {
  FilterMemory memory;
  JointNoise tracker(noise, 1);
  double lag = 0.0;
  for (int i = 0; i < 2.0 * rate; ++i) {
    const double u = (i / rate - 1.0) / 0.75;
    HandJoints joints = moved(open_hand(), Vector3(0.4 * minimum_jerk(std::clamp(u, 0.0, 1.0)), 0, 0));
    const Hand truth = in_world(joints);
    tracker.apply(joints);
    const Hand shown = filtered(in_world(joints), i > 0 ? 1.0 / rate : 0.0, filter, memory);
    double behind = 0.0;
    int known = 0;
    for (int c = 0; c < kPhalanges; ++c) {
      if (!truth.has(c)) continue;
      behind += truth.capsules[c].end.x() - shown.capsules[c].end.x();
      ++known;
    }
    if (u > 0.0) lag = std::max(lag, std::abs(behind) / known);
  }
  return lag;
}

// Filtered by its noise alone, the hand is 16 times as far behind at 5 mm. 30 frames a second are the worst:
// the lag is known one frame after it begins.
TEST(DefaultFilter, is_no_more_than_twice_as_far_behind_a_hand_that_sets_off_as_one_euro_in_any_noise) {
  FilterConfiguration one_euro;
  one_euro.type = FilterKind::one_euro;
  for (const double rate : {30.0, 60.0, 90.0, 120.0}) {
    for (const double noise : {0.0003, 0.001, 0.00125, 0.0015, 0.002, 0.003, 0.005}) {
      EXPECT_LE(lag_at_a_start(FilterConfiguration(), rate, noise),
                2.1 * lag_at_a_start(one_euro, rate, noise))
          << rate << " Hz, " << noise << " m";
    }
  }
}

}  // namespace
}  // namespace mrhi
