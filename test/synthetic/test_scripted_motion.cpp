#include "mr_hand_interaction/synthetic/scripted_motion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "collision/brute_force.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"

namespace mrhi {
namespace {

constexpr double kFine = 1e-3;  // [s] between looks

Hand hand_in_world(const ScriptedMotion& motion, double time) {
  const auto stamp = static_cast<Nanoseconds>(std::llround(1e9 * time));
  const JointsFrame frame = sample(motion, Side::right, stamp, default_device_mount());
  return complete_hand(frame.hands.at(0), default_device_mount());
}

/// Distance of a place from a box about the origin, negative inside [m].
double box_distance(const Vector3& place, const Vector3& half) {
  const Vector3 beyond = place.cwiseAbs() - half;
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

/// Gap between a capsule and a box about the origin [m].
double box_gap(const Capsule& capsule, const Vector3& half) {
  const auto distance = [&](double s) { return box_distance(capsule.axis_point(s), half); };
  return distance(golden_section(distance)) - capsule.radius;
}

/// Gap between a capsule of the hand and where the scene's object would be had nobody touched it [m].
double gap(const ScriptedMotion& motion, double time, const Capsule& in_world) {
  const Vector3 centre = Vector3(0.0, 0.0, 0.22) + time * motion.object_twist.linear;
  const Capsule capsule{in_world.start - centre, in_world.end - centre, in_world.radius};
  if (motion.scene == "ball") return box_gap(capsule, Vector3::Zero()) - 0.03;
  if (motion.scene == "long_cuboid") return box_gap(capsule, {0.01, 0.01, 0.1});
  if (motion.scene == "flat_cuboid") return box_gap(capsule, {0.05, 0.035, 0.006});
  return box_gap(capsule, Vector3::Constant(0.025));
}

/// When each capsule first touches, up to `until`; negative: never.
std::array<double, kCapsules> first_touches(const ScriptedMotion& motion, double until) {
  std::array<double, kCapsules> touches;
  touches.fill(-1.0);
  for (double t = 0.0; t < until; t += kFine) {
    const Hand hand = hand_in_world(motion, t);
    for (std::size_t i = 0; i < kCapsules; ++i) {
      if (touches[i] < 0.0 && hand.has(static_cast<int>(i)) && gap(motion, t, hand.capsules[i]) < 0.0)
        touches[i] = t;
    }
  }
  return touches;
}

/// Time at which the fingers press as far as they will.
double pressed(const ScriptedMotion& motion) {
  for (const Keyframe& key : motion.keyframes) {
    if (key.via_share > 0.0) return key.time;
  }
  throw std::logic_error(motion.name + " does not press");
}

class GraspingMotion : public ::testing::TestWithParam<const char*> {};

TEST_P(GraspingMotion, touches_with_all_fingertips_within_five_milliseconds_and_with_nothing_else_before) {
  const ScriptedMotion motion = make_motion(GetParam());
  const auto touches = first_touches(motion, pressed(motion));
  double first = 1e9, last = -1.0;
  for (int i = 0; i < kCapsules; ++i) {
    const double t = touches[static_cast<std::size_t>(i)];
    if (t < 0.0 || bone_of(i) != 3) continue;
    first = std::min(first, t);
    last = std::max(last, t);
  }
  EXPECT_GE(touches[static_cast<std::size_t>(capsule_index(0, 3))], 0.0) << "the thumb touches";
  EXPECT_LE(last - first, 0.005);
  EXPECT_GT(first, pressed(motion) - 0.7) << "nothing touches before the fingers close";
  for (int i = 0; i < kCapsules; ++i) {
    const double t = touches[static_cast<std::size_t>(i)];
    if (t >= 0.0) {
      EXPECT_GE(t, first) << "capsule " << i;
    }
  }
}

TEST_P(GraspingMotion, closes_slower_than_fifteen_centimetres_a_second_and_presses_two_to_seven_millimetres) {
  const ScriptedMotion motion = make_motion(GetParam());
  const double end = pressed(motion);
  for (int finger = 0; finger < 4; ++finger) {
    const auto tip = static_cast<std::size_t>(capsule_index(finger, 3));
    double before = gap(motion, end - 0.7, hand_in_world(motion, end - 0.7).capsules[tip]);
    for (double t = end - 0.7 + kFine; t < end; t += kFine) {
      const double now = gap(motion, t, hand_in_world(motion, t).capsules[tip]);
      EXPECT_LT((before - now) / kFine, 0.15);
      before = now;
    }
    EXPECT_LT(before, -0.002 + 5e-5);  // reached to a twentieth of a millimetre on a ball
    EXPECT_GT(before, -0.007);
  }
}

INSTANTIATE_TEST_SUITE_P(All, GraspingMotion,
                         ::testing::Values("grasp_cube", "grasp_ball", "catch_ball", "pinch_long",
                                           "lift_flat"));

class AnyMotion : public ::testing::TestWithParam<std::string> {};

TEST_P(AnyMotion, keeps_to_the_limits_of_the_joints) {
  for (const Keyframe& key : make_motion(GetParam()).keyframes) {
    EXPECT_EQ(within_limits(human_hand(), key.posture), key.posture) << key.time;
    if (key.via_share > 0.0) {
      EXPECT_EQ(within_limits(human_hand(), key.via), key.via) << key.time;
    }
  }
}

TEST_P(AnyMotion, moves_no_joint_faster_than_a_person_would) {
  const ScriptedMotion motion = make_motion(GetParam());
  const double fastest = GetParam() == "slap" ? 2.0 : 1.0;  // [m/s]; the slap is meant to be 1.5
  Hand before = hand_in_world(motion, 0.0);
  for (double t = kFine; t < motion.run_time() - 0.5 * kFine; t += kFine) {
    const Hand now = hand_in_world(motion, t);
    for (std::size_t i = 0; i < kPhalanges; ++i) {
      EXPECT_LT((now.capsules[i].end - before.capsules[i].end).norm() / kFine, fastest) << t << " s, " << i;
    }
    before = now;
  }
}

TEST_P(AnyMotion, begins_with_the_hand_clear_of_the_object_in_a_range_that_the_device_sees) {
  const ScriptedMotion motion = make_motion(GetParam());
  for (const Capsule& capsule : hand_in_world(motion, 0.0).capsules) {
    if (capsule.radius > 0.0) {
      EXPECT_GT(gap(motion, 0.0, capsule), 0.02);
    }
  }
  for (double t = 0.0; t < motion.run_time() - 0.5 * kFine; t += 0.01) {
    const Vector3 palm = hand_in_world(motion, t).palm.position;
    EXPECT_GT(palm.z(), 0.05) << t;    // above the device, in the 25 to 600 mm that Leap states
    EXPECT_LT(palm.norm(), 0.7) << t;  // catch_ball is at the edge
  }
}

TEST_P(AnyMotion, shows_no_hand_in_the_pause_and_then_does_the_same_again_with_another_id) {
  const ScriptedMotion motion = make_motion(GetParam());
  const Pose mount = default_device_mount();
  const auto period = static_cast<Nanoseconds>(std::llround(1e9 * motion.period()));
  EXPECT_TRUE(sample(motion, Side::right, period - 500'000'000, mount).hands.empty());
  const HandJoints first = sample(motion, Side::right, 1'000'000'000, mount).hands.at(0);
  const HandJoints second = sample(motion, Side::right, period + 1'000'000'000, mount).hands.at(0);
  EXPECT_EQ(first.joints, second.joints);
  EXPECT_NE(first.id, second.id);
}

TEST_P(AnyMotion, is_mirrored_for_a_left_hand) {
  const ScriptedMotion motion = make_motion(GetParam());
  const HandJoints right = sample(motion, Side::right, 1'700'000'000, Pose{}).hands.at(0);
  const HandJoints left = sample(motion, Side::left, 1'700'000'000, Pose{}).hands.at(0);
  for (std::size_t finger = 0; finger < 5; ++finger) {
    const Vector3 image = right.joints[finger][4]->cwiseProduct(Vector3(-1.0, 1.0, 1.0));
    EXPECT_LT((image - *left.joints[finger][4]).norm(), 1e-12);  // rounding
  }
}

INSTANTIATE_TEST_SUITE_P(All, AnyMotion, ::testing::ValuesIn(motion_names()));

TEST(ScriptedMotion, an_unknown_name_is_refused_with_those_known) {
  try {
    make_motion("wave");
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(
        error.what(),
        "motion 'wave' is not known: use one of grasp_cube, grasp_ball, catch_ball, pinch_long, lift_flat, "
        "nudge, tap, slap, press_button, flip_switch, turn_valve, pull_lever, open_drawer, open_door, "
        "open_hatch, squeeze_tongs");
  }
}

TEST(SyntheticHand, spaces_its_frames_exactly) {
  SyntheticHandOptions options;
  options.rate = 120.0;
  SyntheticHand hand(options);
  for (int i = 0; i < 360; ++i) EXPECT_EQ(hand.next().stamp, (i * 1'000'000'000LL + 60) / 120);
}

TEST(SyntheticHand, refuses_what_is_out_of_range_naming_it) {
  SyntheticHandOptions options;
  options.rate = 0.0;
  EXPECT_THROW(SyntheticHand{options}, std::invalid_argument);
  options = {};
  options.side = "middle";
  EXPECT_THROW(SyntheticHand{options}, std::invalid_argument);
  options = {};
  options.noise = std::nan("");
  EXPECT_THROW(SyntheticHand{options}, std::invalid_argument);
}

}  // namespace
}  // namespace mrhi
