#include <gtest/gtest.h>

#include "support/bar_by_its_end.h"

namespace mrhi {
namespace {

using testing::kDegrees;
using testing::Swing;

Swing held_by_its_end(bool torsion, double step) {
  Configuration configuration = testing::implicit_configuration();
  configuration.contact.torsion = torsion;
  configuration.step = step;
  return testing::swing_about_finger_line(configuration);
}

TEST(ImplicitTorsion, two_fingertips_hold_a_long_bar_by_its_end_against_turning_about_the_finger_line) {
  for (const double step : {0.001, 1.0 / 119.0}) {
    const Swing swing = held_by_its_end(true, step);
    RecordProperty("largest_degrees", std::to_string(swing.largest / kDegrees));
    EXPECT_TRUE(swing.held);
    EXPECT_LE(swing.largest, 1.0 * kDegrees) << step;
    EXPECT_LE(swing.after, 0.01 * kDegrees) << step;
  }
}

TEST(ImplicitTorsion, without_it_the_bar_swings) {
  const Swing swing = held_by_its_end(false, 0.001);
  RecordProperty("largest_degrees", std::to_string(swing.largest / kDegrees));
  EXPECT_GE(swing.largest, 10.0 * kDegrees);
}

// It is at rest, so the hand's torque about its centre is zero: the soft fingers' is part of it.
TEST(ImplicitTorsion, is_reported_with_the_contacts_of_a_bar_that_rests_by_its_end) {
  Scene scene = testing::scene_of(testing::stiff_box(testing::kBar, testing::kBarMass));
  scene.gravity = Vector3(0.0, 0.0, -0.1);
  Simulation simulation(scene, testing::implicit_configuration());
  testing::play(simulation, 0.0, 3.0, 120.0, testing::closing_on_the_end);
  const Vector3& centre = simulation.state().bodies[0].pose.position;
  Vector3 of_forces = Vector3::Zero(), of_pads = Vector3::Zero();
  for (const Contact& contact : simulation.result().contacts) {
    of_forces += (contact.point - centre).cross(contact.force);
    of_pads += contact.torque * contact.normal;
  }
  EXPECT_GT(of_forces.norm(), 1e-4);
  EXPECT_LT((of_forces + of_pads).norm(), 0.01 * of_forces.norm());
}

/// A bar held by its end at a hundredth of a g, with ten small cubes on it: more bodies than are solved for
/// exactly. How far its other end has sunk about the finger line [rad].
double sunk_under_a_crowd(const Configuration& configuration) {
  Scene scene = testing::scene_of(testing::stiff_box(testing::kBar, testing::kBarMass));
  scene.gravity = Vector3(0.0, 0.0, -0.1);
  constexpr double kCube = 0.008;  // [m]
  for (int i = 0; i < 10; ++i) {
    Body cube = testing::stiff_box(Vector3::Constant(kCube), 0.001);
    cube.name = "cube" + std::to_string(i);
    cube.start.position = Vector3(0.0, -0.06 + 0.015 * i, 0.5 * (testing::kBar.z() + kCube));
    scene.bodies.push_back(cube);
  }
  Simulation simulation(scene, configuration);
  testing::play(simulation, 0.0, 3.0, 120.0, testing::closing_on_the_end);
  EXPECT_EQ(simulation.state().interactions[0].level, InteractionLevel::grasp);
  // The cubes lie on what is held, and have fallen off what is not.
  EXPECT_EQ(simulation.state().body_contacts.size(), configuration.contact.torsion ? 40u : 0u);
  const Quaternion& turn = simulation.state().bodies[0].pose.orientation;
  return std::abs(2.0 * std::atan2(turn.x(), turn.w()));
}

TEST(ImplicitTorsion, holds_a_bar_by_its_end_under_a_crowd_too_be_it_a_persons_hand_or_the_papers) {
  Configuration configuration = testing::implicit_configuration();
  for (const HandStrength& hand : {HandStrength::of_a_person(), HandStrength()}) {
    configuration.contact.hand = hand;
    const double sunk = sunk_under_a_crowd(configuration);
    RecordProperty("sunk_degrees_pad_" + std::to_string(hand.pad), std::to_string(sunk / kDegrees));
    EXPECT_LE(sunk, 1.0 * kDegrees) << hand.pad;
  }
  configuration.contact.torsion = false;
  EXPECT_GE(sunk_under_a_crowd(configuration), 10.0 * kDegrees);
}

}  // namespace
}  // namespace mrhi
