#include <gtest/gtest.h>

#include "mr_hand_interaction/scene/scene.h"
#include "support/reaching_hand.h"

namespace mrhi {
namespace {

/// A cube of a mode of its own, in the hand that closes and carries it, with the shipped configuration.
struct ModeOutcome {
  Vector3 place, velocity;
  double off = 0.0;
  bool grasped = false;
};

ModeOutcome outcome_of(GraspMode mode, bool parameter) {
  Configuration configuration;
  configuration.contact.grasp_assist = parameter;
  Body cube = testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 0.1);
  cube.grasp = mode;
  Simulation simulation(testing::scene_of(cube), configuration);
  ModeOutcome outcome;
  Vector3 shift = Vector3::Zero();
  testing::play(
      simulation, 0.0, 1.5, 120.0,
      [&](double t) {
        shift = 0.1 * testing::smooth(t - 0.5, 0.5) * Vector3::UnitY();
        return testing::reaching(std::min(t / 0.2, 1.0), 0.012, 0.01, shift);
      },
      [&](const Simulation& s) {
        for (const Event& event : s.result().events)
          outcome.grasped = outcome.grasped || event.kind == EventKind::grasp_begin;
      });
  outcome.place = simulation.state().bodies[0].pose.position;
  outcome.velocity = testing::object_twist(simulation).linear;
  outcome.off = (outcome.place - shift).norm();
  return outcome;
}

TEST(GraspAssist, an_object_says_itself_whether_it_is_assisted) {
  for (const bool parameter : {true, false}) {
    const ModeOutcome with = outcome_of(GraspMode::parameter, true),
                      without = outcome_of(GraspMode::parameter, false),
                      assist = outcome_of(GraspMode::assist, parameter),
                      free = outcome_of(GraspMode::free, parameter);
    EXPECT_EQ(assist.place, with.place) << parameter;
    EXPECT_EQ(free.place, without.place) << parameter;
    EXPECT_NE(with.place, without.place);
  }
}

// Of the 10 cm by which the hand carries others it makes only what fingers gave it as they closed.
TEST(GraspAssist, what_is_never_grasped_is_pushed_and_not_carried) {
  for (const bool parameter : {true, false}) {
    const ModeOutcome never = outcome_of(GraspMode::never, parameter);
    EXPECT_FALSE(never.grasped) << parameter;
    EXPECT_LT(std::abs(never.place.y()), 0.01) << parameter;
    EXPECT_TRUE(outcome_of(GraspMode::parameter, parameter).grasped) << parameter;
  }
  Body cube = testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 0.1);
  cube.grasp = GraspMode::never;
  Simulation simulation(testing::scene_of(cube), Configuration());
  testing::play(simulation, 0.0, 1.0, 120.0, [&](double t) {
    Hand hand = testing::empty_hand();
    testing::add_fingertip(hand, capsule_index(1, 3), Vector3(0.03 - 0.04 * testing::smooth(t, 0.5), 0, 0),
                           Vector3::UnitX(), 1.2);
    return hand;
  });
  EXPECT_LT(simulation.state().bodies[0].pose.position.x(), -0.025);
}

TEST(GraspAssist, fingers_closed_round_what_is_never_grasped_apply_no_force) {
  Body cube = testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 0.1);
  cube.grasp = GraspMode::never;
  Simulation simulation(testing::scene_of(cube), Configuration());
  double strongest = 0.0;
  testing::play(
      simulation, 0.0, 1.0, 120.0,
      [](double t) { return testing::reaching(0.5 + 0.5 * testing::smooth(t, 0.4), 0.012, 0.0); },
      [&](const Simulation& s) {
        for (const Contact& contact : s.result().contacts)
          strongest = std::max(strongest, contact.force.norm());
      });
  EXPECT_LT(strongest, 1e-3);
}

// Either hand has one finger on it.
TEST(GraspAssist, two_hands_do_not_hold_what_is_never_grasped) {
  Body cube = testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 0.1);
  cube.grasp = GraspMode::never;
  Simulation simulation(testing::scene_of(cube), Configuration());
  double strongest = 0.0;
  for (int i = 0; i <= 120; ++i) {
    const double t = i / 120.0, deep = 0.006 * testing::smooth(t, 0.4) - 0.002;
    std::vector<Hand> hands;
    for (const double side : {1.0, -1.0}) {
      hands.push_back(testing::empty_hand(side > 0.0 ? 1 : 2, side > 0.0 ? Side::right : Side::left));
      testing::add_fingertip(hands.back(), capsule_index(1, 3),
                             Vector3(side * (testing::kReachedHalf - deep), 0, 0), side * Vector3::UnitX(),
                             1.2);
    }
    ASSERT_EQ(simulation.advance({testing::at(t), hands}), Rejection::none);
    for (const Contact& contact : simulation.result().contacts)
      strongest = std::max(strongest, contact.force.norm());
  }
  EXPECT_LT(strongest, 1e-3);
}

}  // namespace
}  // namespace mrhi
