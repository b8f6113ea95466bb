// Which closings are found, which count as held, and the statistics; on synthetic recordings.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>

#include "../arctic.h"
#include "../contenders.h"
#include "../report.h"
#include "../statistics.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "synthetic/motions.h"

namespace mrhi::real_grasps {
namespace {

constexpr double kPeriod = 0.01;  // [s]
const Row kCube{"cube", Kind::pinch, false, 0.04, 0.1};
constexpr double kLimit = 0.04 + 2.0 * 0.0088;  // distance of the fingertips at first touch with the cube [m]

/// Tips of thumb and index around the origin, at the distance `opening(time)`.
Recording two_tips(double seconds, const std::function<double(double)>& opening) {
  std::vector<JointsFrame> frames;
  for (int i = 0; i * kPeriod < seconds; ++i) {
    HandJoints hand;
    hand.id = 7;
    const double half = 0.5 * opening(i * kPeriod);
    hand.joints[0][4] = Vector3(-half, 0, 0), hand.joints[0][3] = Vector3(-half, -0.03, 0);
    hand.joints[1][4] = Vector3(half, 0, 0), hand.joints[1][3] = Vector3(half, -0.03, 0);
    frames.push_back({std::llround(1e9 * i * kPeriod), {hand}});
  }
  return make_recording("two_tips", std::move(frames));
}

/// Open by 0.1 m, closed to `least` from `from` to `to`, with 0.05 s of motion.
std::function<double(double)> closing_once(double from, double to, double least) {
  return [=](double t) {
    const double inside = std::min(t - from, to - t) / 0.05;
    return 0.1 + (least - 0.1) * std::min(1.0, std::max(0.0, inside));
  };
}

TEST(Closings, OneIsFoundWhereTheTipsComeNearerThanTheBodyIsWide) {
  const auto found = closings(two_tips(3.0, closing_once(1.0, 2.0, 0.03)), kCube);
  ASSERT_EQ(found.size(), 1u);
  // From 0.1 m to 0.03 m in 0.05 s: at the limit 0.0303 s after 1 s, seen in the frame after.
  EXPECT_NEAR(found[0].closed, 1.04, 1e-9);
  EXPECT_NEAR(found[0].opens, 1.96, 1e-9);
  EXPECT_LT(found[0].place.position.norm(), 1e-12) << "between the tips";
  EXPECT_NEAR(std::abs((found[0].place.orientation * Vector3::UnitX()).x()), 1.0, 1e-12)
      << "along their line";
  EXPECT_EQ(found[0].hand, 7u);
}

TEST(Closings, ItIsPlayedFromWhereNothingIsNearToFourTenthsAfterItOpened) {
  const Recording recording = two_tips(3.0, closing_once(1.0, 2.0, 0.03));
  const Closing closing = closings(recording, kCube).at(0);
  const auto clear_at = [&](std::size_t frame) {
    return clearance(recording.sightings[frame], kCube, closing.place) > 0.002;
  };
  EXPECT_TRUE(clear_at(closing.begin));
  EXPECT_FALSE(clear_at(closing.begin + 1)) << "not earlier than need be";
  EXPECT_NEAR(static_cast<double>(closing.last) * kPeriod, closing.opens + 0.4, 1e-9);
}

TEST(Closings, ShortOnesShallowOnesAndThoseNotSeenToEndAreLeftOut) {
  EXPECT_TRUE(closings(two_tips(3.0, closing_once(1.0, 1.2, 0.03)), kCube).empty()) << "0.13 s";
  EXPECT_TRUE(closings(two_tips(3.0, closing_once(1.0, 2.0, kLimit - 0.003)), kCube).empty());
  EXPECT_FALSE(closings(two_tips(3.0, closing_once(1.0, 2.0, kLimit - 0.005)), kCube).empty());
  EXPECT_TRUE(closings(two_tips(3.0, closing_once(1.0, 9.0, 0.03)), kCube).empty()) << "never opens";
}

TEST(Closings, AHandThatWasNotSeenComingIsLeftOut) {
  Recording recording = two_tips(3.0, closing_once(1.0, 2.0, 0.03));
  recording.frames.erase(recording.frames.begin() + 95, recording.frames.begin() + 103);
  EXPECT_TRUE(closings(make_recording("gap", recording.frames), kCube).empty()) << "0.09 s without a frame";
}

TEST(Closings, AtMostTenOfARecording) {
  const auto often = [](double t) { return closing_once(0.2, 0.6, 0.03)(std::fmod(t, 0.8)); };
  EXPECT_EQ(closings(two_tips(16.0, often), kCube).size(), 10u);
}

TEST(Clearance, IsTheDistanceOfTheSkinFromTheBody) {
  const Recording recording = two_tips(0.1, [](double) { return 0.1; });
  EXPECT_NEAR(clearance(recording.sightings[0], kCube, {}), 0.05 - 0.02 - 0.0088, 1e-12);
  const Row ball{"ball", Kind::pinch, true, 0.06, 0.1};
  EXPECT_NEAR(clearance(recording.sightings[0], ball, {}), 0.05 - 0.03 - 0.0088, 1e-12);
}

/// A body at rest at `place`, grasped at 1 s, loaded until 2.1 s, in a hand that opens at 2 s.
struct PlayedClosing {
  Recording recording = two_tips(3.0, closing_once(1.0, 2.0, 0.03));
  Closing closing = closings(recording, kCube).at(0);
  Playback playback;

  explicit PlayedClosing(double place) {
    for (int i = 90; i < 240; ++i)
      playback.moments.push_back({i * kPeriod, Vector3(0, place, 0), Vector3::Zero(), i > 100 && i < 210});
    playback.has_grasps = true;
    playback.grasp_began = 1.0;
    playback.grasp_ended = 2.1;
  }
  Outcome outcome() const { return outcome_of(playback, recording.tracks[0], closing, kCube); }
};

TEST(Held, IsWhatIsGraspedAndInTheHandUntilItOpens) {
  EXPECT_TRUE(PlayedClosing(0.0).outcome().held);
  EXPECT_TRUE(PlayedClosing(0.039).outcome().held) << "nearer than the body is wide";
  EXPECT_FALSE(PlayedClosing(0.041).outcome().held);
}

TEST(Held, NotWhatIsNeverGraspedOrLetGoTooEarly) {
  PlayedClosing played(0.0);
  played.playback.grasp_ended = played.closing.opens - 0.05;
  EXPECT_TRUE(played.outcome().held) << "within the time that a grasp may end before the hand opens";
  played.playback.grasp_ended = played.closing.opens - 0.07;
  EXPECT_FALSE(played.outcome().held);
  played.playback.grasp_ended.reset();
  played.playback.grasp_began.reset();
  EXPECT_FALSE(played.outcome().held);
  EXPECT_TRUE(played.outcome().carried);
  played.playback.has_grasps = false;
  EXPECT_TRUE(played.outcome().held) << "by an engine that does not know grasps";
}

TEST(Held, CarriedIsNotWhatNothingPresses) {
  PlayedClosing played(0.0);
  for (Moment& moment : played.playback.moments) moment.loaded = false;
  EXPECT_FALSE(played.outcome().carried);
}

TEST(Held, NudgedAndReleasedAreReported) {
  const Outcome outcome = PlayedClosing(0.012).outcome();
  EXPECT_NEAR(outcome.early, 0.012, 1e-12);
  ASSERT_TRUE(outcome.released);
  EXPECT_NEAR(*outcome.released, 2.1, 1e-6);
}

/// A scripted hand that grasps a cube of 40 mm, applied to one of 44 mm, which its tips penetrate by 2 mm.
std::vector<Event> scripted(const Configuration& configuration, const Disturbance& disturbance = {}) {
  SyntheticHandOptions options;
  options.motion = "grasp_cube";
  const Recording recording = make_recording("scripted", record_motion(options));
  const Row row{"cube", Kind::grab, false, 0.044, 0.1};
  std::vector<Event> events;
  for (const Closing& closing : closings(recording, row))
    events.push_back(
        {"scripted", closing, play(recording, closing, row, disturbance, ours(configuration).player), ""});
  return events;
}

TEST(Played, AScriptedHandHoldsTheCubeThatIsPutWhereItCloses) {
  const auto events = scripted(Configuration());
  ASSERT_EQ(events.size(), 1u);
  EXPECT_EQ(events[0].outcome.note, "");
  EXPECT_TRUE(events[0].outcome.held);
  EXPECT_TRUE(events[0].outcome.carried);
  EXPECT_GT(events[0].outcome.force, 0.0);
  EXPECT_EQ(summarise(events).held, 1u);
}

TEST(Played, WithoutFrictionItLosesIt) {
  Configuration slippery;
  slippery.material.static_friction = slippery.material.dynamic_friction = 0.0;
  const auto events = scripted(slippery);
  ASSERT_EQ(events.size(), 1u);
  EXPECT_LT(scripted(Configuration())[0].outcome.away, events[0].outcome.away);
}

TEST(Disturbed, IsEvenlySpacedAsNoisyAsSaidAndTheSameForOneSeed) {
  const Recording recording = two_tips(4.0, [](double) { return 0.1; });
  Disturbance disturbance;
  disturbance.noise = 0.002;
  disturbance.rate = 30.0;
  const auto frames = disturbed(recording.frames, 0, recording.frames.size() - 1, disturbance);
  const auto again = disturbed(recording.frames, 0, recording.frames.size() - 1, disturbance);
  disturbance.seed = 2;
  const auto other = disturbed(recording.frames, 0, recording.frames.size() - 1, disturbance);
  ASSERT_EQ(frames.size(), 120u);
  double squares = 0.0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const Vector3 tip = *frames[i].hands.at(0).joints[0][4];
    EXPECT_EQ(frames[i].stamp, static_cast<Nanoseconds>(i) * 33333333);
    EXPECT_EQ(tip, *again[i].hands.at(0).joints[0][4]);
    EXPECT_NE(tip, *other[i].hands.at(0).joints[0][4]);
    squares += (tip - Vector3(-0.05, 0, 0)).squaredNorm() / 3.0;
  }
  // The deviation of 360 numbers has a relative error of 1 / sqrt(720) = 3.7 %; four times that.
  EXPECT_NEAR(std::sqrt(squares / static_cast<double>(frames.size())), 0.002, 0.15 * 0.002);
}

/// First action on the scene's cube in a scripted hand's path, or on one displaced by `aside` [m].
std::optional<FirstMotion> first_motion_of(const std::string& motion, double aside = 0.0) {
  SyntheticHandOptions options;
  options.motion = motion;
  SyntheticHand hand(options);
  Scene scene;
  scene.bodies.push_back(body_of({"cube", Kind::pinch, false, 0.05, 0.1},
                                 {scene_object() + aside * Vector3::UnitY(), Quaternion::Identity()}, {}));
  Configuration configuration;
  configuration.contact.grasp_assist = false;
  Simulation simulation(scene, configuration);
  std::vector<std::string> left_out;
  double before = 0.0;
  while (hand.next_run() == 0) {
    const auto frame = complete_frame(hand.next(), device_mount(), left_out);
    if (!frame || simulation.advance(*frame) != Rejection::none) continue;
    const double time = to_seconds(simulation.result().stamp);
    if (before > 0.0)
      if (const auto first = first_motion(simulation, 0, time - before)) return first;
    before = time;
  }
  return std::nullopt;
}

TEST(FirstMotion, FollowsFromWhatTheHandDid) {
  ASSERT_TRUE(first_motion_of("slap"));
  EXPECT_EQ(first_motion_of("slap")->cause, MotionCause::sweep);
  ASSERT_TRUE(first_motion_of("tap"));
  EXPECT_EQ(first_motion_of("tap")->cause, MotionCause::closing);
  EXPECT_FALSE(first_motion_of("slap", 1.0));
}

TEST(Statistics, WilsonsIntervalIsThatOfTables) {
  // Calculated by hand from Brown, Cai and DasGupta (2001), equation 4.
  EXPECT_NEAR(wilson(8, 10).low, 0.4902, 1e-4);
  EXPECT_NEAR(wilson(8, 10).high, 0.9433, 1e-4);
  EXPECT_EQ(wilson(0, 10).low, 0.0);
  EXPECT_NEAR(wilson(0, 10).high, 0.2775, 1e-4);
  EXPECT_EQ(wilson(0, 0).high, 1.0) << "nothing known";
}

TEST(Statistics, AQuantileLiesBetweenItsNeighbours) {
  EXPECT_DOUBLE_EQ(quantile({4.0, 1.0, 3.0, 2.0}, 0.5), 2.5);
  EXPECT_DOUBLE_EQ(quantile({1.0, 2.0, 3.0}, 0.9), 2.8);
  EXPECT_DOUBLE_EQ(quantile({}, 0.9), 0.0);
}

// Trials of one group with equal outcomes count as one trial for an interval.
TEST(Statistics, AnIntervalByGroupsIsWiderWhereTheirTrialsDependOnEachOther) {
  const std::vector<SuccessCount> apart(40, {0, 1});
  std::vector<SuccessCount> even = apart, clustered;
  for (std::size_t i = 0; i < even.size(); i += 2) even[i].successes = 1;
  for (int i = 0; i < 4; ++i) clustered.push_back({i % 2 == 0 ? 10u : 0u, 10u});
  const Interval independent = grouped(even), dependent = grouped(clustered), single = wilson(20, 40);
  EXPECT_NEAR(independent.low, single.low, 0.03);
  EXPECT_NEAR(independent.high, single.high, 0.03);
  EXPECT_LT(dependent.low, 0.1);
  EXPECT_GT(dependent.high, 0.9);
  EXPECT_EQ(grouped({}).high, 1.0) << "nothing known";
  EXPECT_LT(grouped({{5, 5}, {5, 5}}).low, 0.8) << "not as sure as the bootstrap of equal groups says";
}

TEST(Recordings, TheirDescriptionMaySayWhatTheHandHadBeforeIt) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "mrhi_described_recordings";
  std::filesystem::create_directories(folder);
  const std::string csv = (folder / "one.csv").string(), description = (folder / "one.meta.json").string();
  std::ofstream(csv) << "time_s,hand_id,is_left,index_j4_x,index_j4_y,index_j4_z\n0,1,0,0,0.2,0\n";
  std::filesystem::remove(description);
  EXPECT_EQ(load_recording(csv).object, "");
  for (const char* object : kObjects) {
    std::ofstream(description) << "{\"name\": \"one\", \"object\": \"" << object << "\"}";
    EXPECT_EQ(load_recording(csv).object, object);
  }
  std::ofstream(description) << "{\"object\": \"heard\"}";
  EXPECT_THROW(load_recording(csv), std::runtime_error);
  std::filesystem::remove_all(folder);
}

/// Two hands that move by `step` along x from frame to frame, the left one twice as fast, and an object at
/// `object` steps.
Window carried(double step, double object) {
  Window window;
  for (int i = 0; i < 5; ++i) {
    window.frames.push_back({i * Nanoseconds(33'000'000), {}});
    for (const Side side : {Side::right, Side::left}) {
      HandJoints hand;
      hand.id = side == Side::right ? 1 : 2;
      hand.side = side;
      const Vector3 at((side == Side::right ? 1 : 2) * step * i, 0, side == Side::right ? 0 : 1);
      for (std::size_t f = 0; f < kFingers; ++f) {
        for (std::size_t j = 0; j < 5; ++j)
          hand.joints[f][j] = at + Vector3(0.02 * static_cast<double>(f), f == 0 ? 0.03 : 0.0,
                                           0.1 - 0.03 * static_cast<double>(j));
      }
      window.frames.back().hands.push_back(hand);
    }
    const Pose there{Vector3(object * i, 0, 0), Quaternion::Identity()};
    window.places.push_back(device_mount() * there);
  }
  window.free_from = 1;
  return window;
}

TEST(Arctic, ARigidHandCarriesWhatGoesWithEitherHand) {
  for (const double faster : {1.0, 2.0}) {
    const WindowOutcome outcome = play_rigidly(carried(0.03, 0.03 * faster));
    ASSERT_EQ(outcome.away.size(), 3u);
    for (const double away : outcome.away) EXPECT_LT(away, 1e-6) << "sizes are in float32";
  }
  const WindowOutcome left_behind = play_rigidly(carried(0.03, 0.0));
  ASSERT_EQ(left_behind.away.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(left_behind.away[i], 0.03 * static_cast<double>(i + 1), 1e-6);
}

TEST(Arctic, AnObjectOnAHingeIsLetFreeWithTheSpeedThatItsHingeHad) {
  constexpr double kSpeed = 1.0;  // [rad/s]
  Window window = carried(0.0, 0.0);
  window.scene.bounds = {Vector3::Constant(-10.0), Vector3::Constant(10.0)};
  Body lid = body_of(kCube, {Vector3(5.05, 0, 0), Quaternion::Identity()}, {}), box = lid;
  box.name = "box", lid.name = "lid";
  box.start.position.x() = 5.0;           // out of the hands' reach
  box.mass *= 90.0, box.inertia *= 90.0;  // practically fixed beside a lid of a tenth of a gram
  lid.mass *= 1e-3, lid.inertia *= 1e-3;
  window.scene.bodies = {box, lid};
  Joint hinge;
  hinge.name = "hinge", hinge.parent = 0, hinge.child = 1, hinge.axis = Vector3::UnitZ();
  hinge.in_child.position = Vector3(-0.05, 0, 0);
  window.scene.joints = {hinge};
  for (std::size_t i = 0; i < window.frames.size(); ++i) {
    window.places[i] = box.start;
    window.angles.push_back(kSpeed * to_seconds(window.frames[i].stamp));
  }
  const WindowOutcome outcome = play(window, Configuration(), 0.0);
  ASSERT_EQ(outcome.turned.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_LT(outcome.away[i], 1e-5);
    EXPECT_LT(outcome.turned[i], 1e-4);
  }
}

// The hands move along x by 3 cm per frame; their skin is at 8.9 cm in the first one.
TEST(Arctic, AWindowIsLedFromWhereNoHandTouchesItsObject) {
  Window window = carried(0.03, 0.0);
  window.scene.bounds = {Vector3::Constant(-10.0), Vector3::Constant(10.0)};
  const Vector3 from_first_to_second(0.14, 0.0, 0.04);
  window.scene.bodies = {
      body_of(kCube, device_mount() * Pose{from_first_to_second, Quaternion::Identity()}, {})};
  for (Pose& place : window.places) place = window.scene.bodies[0].start;
  window.free_from = 3;
  EXPECT_EQ(last_clear(window, Configuration()), 1u);
}

TEST(Arctic, AHingeThatIsElsewhereIsNotWithin) {
  const std::vector<WindowOutcome> outcomes{{{0.01, 0.01}, {0.1, 0.3}, {}, {}}};
  EXPECT_DOUBLE_EQ(fraction_within(outcomes, 0.02), 1.0);
  EXPECT_DOUBLE_EQ(fraction_within(outcomes, 0.02, 0.2), 0.5);
}

TEST(Arctic, SharesAreOfAllFramesTogether) {
  const std::vector<WindowOutcome> outcomes{{{0.01, 0.03, 0.06}, {}, {1.0}, {}}, {{0.0}, {}, {2.0, 3.0}, {}}};
  EXPECT_DOUBLE_EQ(fraction_within(outcomes, 0.05), 0.75);
  EXPECT_DOUBLE_EQ(fraction_within(outcomes, 0.02), 0.5);
  EXPECT_EQ(stayed(outcomes, 0.05), 1u);
  EXPECT_DOUBLE_EQ(force_p90(outcomes), 2.8);
}

/// A window of a capture, `within` of whose ten frames are near.
WindowOutcome near_in(const std::string& capture, std::size_t within) {
  WindowOutcome outcome;
  outcome.labels.capture = capture;
  for (std::size_t i = 0; i < 10; ++i) outcome.away.push_back(i < within ? 0.01 : 1.0);
  return outcome;
}

// The frames of a capture depend on each other: only captures are drawn anew.
TEST(Arctic, IntervalsAreOfCaptures) {
  const std::vector<WindowOutcome> one_capture{near_in("a", 10), near_in("a", 0)};
  const Interval none = fraction_interval(one_capture, 0.02);
  EXPECT_DOUBLE_EQ(none.low, 0.5);
  EXPECT_DOUBLE_EQ(none.high, 0.5);
  const Interval of_two = fraction_interval({near_in("a", 10), near_in("b", 0)}, 0.02);
  EXPECT_DOUBLE_EQ(of_two.low, 0.0);
  EXPECT_DOUBLE_EQ(of_two.high, 1.0);
}

TEST(Arctic, TheSameWindowsAreComparedCaptureByCapture) {
  const std::vector<WindowOutcome> hand{near_in("a", 10), near_in("b", 3)},
      rigid{near_in("b", 1), near_in("a", 8)};
  const Interval interval =
      difference_interval(hand, rigid, 0.02);  // a fifth better in each, however they are drawn
  EXPECT_NEAR(interval.low, 0.2, 1e-12);
  EXPECT_NEAR(interval.high, 0.2, 1e-12);
}

TEST(Arctic, WindowsAreCountedByPersonAndObject) {
  std::vector<WindowOutcome> outcomes{near_in("a", 10), near_in("b", 5), near_in("c", 0)};
  outcomes[0].labels.person = outcomes[2].labels.person = "P1";
  outcomes[1].labels.person = "P2";
  const auto people = by_label(outcomes, &WindowLabels::person);
  ASSERT_EQ(people.size(), 2u);
  EXPECT_DOUBLE_EQ(fraction_within(people.at("P1"), 0.02), 0.5);
  EXPECT_DOUBLE_EQ(fraction_within(people.at("P2"), 0.02), 0.5);
}

}  // namespace
}  // namespace mrhi::real_grasps
