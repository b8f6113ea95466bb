#include <gtest/gtest.h>

#include "synthetic/working.h"

namespace mrhi {
namespace {

using testing::Staging;
using testing::Work;
using testing::Worked;
using testing::works;

constexpr double kGravity = -9.81;  // [m/s^2]

bool is_tongs(const Work& work) {
  return std::string(work.motion) == "squeeze_tongs";
}

/// Tongs lie on nothing: there gravity sets in once they are held.
Staging staged(const Work& work, double gravity) {
  Staging staging;
  staging.gravity = gravity;
  if (is_tongs(work)) staging.gravity_from = 3.2;
  return staging;
}

bool succeeds(const Work& work, const Worked& worked) {
  return worked.held && worked.finite && std::abs(worked.furthest - work.to) <= work.within &&
         std::abs(worked.left - work.left) <= work.within && worked.fastest < work.fastest &&
         worked.crept < 1e-5;
}

struct Tracker {
  double noise, rate, dropped;  // [m] on every joint, [1/s], share of the frames
};

/// A third of the frames that do not come, and noise from a good tracker's to ten times worse.
const Tracker kTrackers[] = {{0.001, 30, 0.0}, {0.003, 120, 0.0}, {0.005, 60, 0.0}, {0.003, 90, 0.33}};

class WorkingMotion : public ::testing::TestWithParam<Work> {};

TEST_P(WorkingMotion, takes_its_joint_along_and_leaves_it_where_it_stays) {
  for (const double gravity : {0.0, kGravity}) {
    const Worked worked = work_at(GetParam(), staged(GetParam(), gravity));
    EXPECT_TRUE(succeeds(GetParam(), worked)) << worked.furthest << " then " << worked.left;
    // A hinge sags under gravity on its detent by what its spring gives; nothing else moves untouched.
    const double sag = std::string(GetParam().motion) == "flip_switch" ? 0.035 : 1e-6;
    EXPECT_LT(worked.moved_before, sag);
    EXPECT_LT(worked.crept, 1e-9);
  }
}

/// All of ten seeds with each tracker, at 0 g and 1 g. (Free tongs are batted away by a hand this noisy:
/// below.)
TEST_P(WorkingMotion, succeeds_under_noise_and_dropouts) {
  if (is_tongs(GetParam())) return;
  for (const double gravity : {0.0, kGravity}) {
    for (const Tracker& tracker : kTrackers) {
      for (std::uint64_t seed = 11; seed < 14; ++seed) {
        Staging staging = staged(GetParam(), gravity);
        staging.noise = tracker.noise, staging.rate = tracker.rate, staging.dropped = tracker.dropped;
        staging.seed = seed;
        const Worked worked = work_at(GetParam(), staging);
        EXPECT_TRUE(succeeds(GetParam(), worked))
            << "gravity " << gravity << ", noise " << tracker.noise << ", rate " << tracker.rate
            << ", dropped " << tracker.dropped << ", seed " << seed << ": held " << worked.held
            << ", furthest " << worked.furthest << ", left " << worked.left << ", fastest " << worked.fastest
            << ", crept " << worked.crept;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, WorkingMotion, ::testing::ValuesIn(works()),
                         [](const auto& tested) { return std::string(tested.param.motion); });

TEST(Tongs, are_worked_by_a_hand_of_a_good_tracker) {
  const Work& tongs = works().back();
  ASSERT_TRUE(is_tongs(tongs));
  int succeeded = 0;
  for (std::uint64_t seed = 11; seed < 16; ++seed) {
    Staging staging = staged(tongs, 0.0);
    staging.noise = 0.001, staging.rate = 30.0, staging.seed = seed;
    succeeded += succeeds(tongs, work_at(tongs, staging));
  }
  EXPECT_EQ(succeeded, 5);
}

/// Each tells what it has come to: the button its end and its return, the switch a click, what was latched
/// that it is open.
TEST(WorkingMotionEvents, are_told) {
  for (const Work& work : works()) {
    const Worked worked = work_at(work, staged(work, 0.0));
    const std::string motion = work.motion;
    EXPECT_EQ(worked.clicks, motion == "flip_switch" ? 1 : 0) << motion;
    EXPECT_EQ(worked.opened, motion == "open_hatch"                             ? 3
                             : motion == "open_drawer" || motion == "open_door" ? 1
                                                                                : 0)
        << motion;
    if (motion == "press_button") {
      EXPECT_EQ(worked.limits, 2);
    }
  }
}

/// Latches hold what they are before: pulled by its handle the hatch stays shut.
TEST(Hatch, stays_shut_while_its_latches_are_before_it) {
  SyntheticHandOptions options;
  options.motion = "open_hatch";
  SyntheticHand source(options);
  Configuration configuration;
  Simulation simulation(testing::staged_scene(source.motion(), configuration), configuration);
  const auto hinge = static_cast<std::size_t>(*find_joint(simulation.scene(), "hatch_hinge"));
  double furthest = 0.0;
  while (source.next_run() == 0) {
    JointsFrame joints = source.next();
    if (to_seconds(joints.stamp) < 10.0) joints.hands.clear();  // without the part that turns the latches
    HandFrame frame{joints.stamp, {}};
    for (const HandJoints& hand : joints.hands)
      frame.hands.push_back(complete_hand(hand, default_device_mount()));
    simulation.advance(frame);
    furthest = std::max(furthest, simulation.state().joints[hinge].position);
  }
  EXPECT_GT(furthest, 0.005);  // the room before the latches
  EXPECT_LT(furthest, 0.05);
}

}  // namespace
}  // namespace mrhi
