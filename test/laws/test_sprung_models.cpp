#include <gtest/gtest.h>

#include "mr_hand_interaction/response/contact_model.h"
#include "support/pinched_cube.h"

namespace mrhi {
namespace {

using testing::fixed_block;
using testing::lying;
using testing::object_twist;
using testing::PinchedCube;
using testing::smooth;
using testing::total_force;

constexpr double kTipRadius = 0.008;  // of a fingertip [m]

/// What holds of the models that couple the hand by springs and dampers.
class SprungModel : public ::testing::TestWithParam<ContactModelKind> {};

TEST_P(SprungModel, carries_a_pinched_cube_along) {
  PinchedCube pinch(GetParam());
  const Vector3 way(0.05, 0.03, 0.1);
  pinch.hold(1.0);
  const Vector3 before = pinch.cube().pose.position;
  pinch.play(4.0, [&](double t) -> Vector3 { return smooth(t - 1.0, 1.0) * way; });
  // The greatest force of this way, 0.07 N, is at most a twentieth of what friction gives: nothing slips for
  // good.
  EXPECT_LE((pinch.cube().pose.position - before - way).norm(), 1e-6);
  EXPECT_LE(pinch.energy(), 1e-12);
}

TEST_P(SprungModel, never_pulls) {
  Simulation simulation = fixed_block(GetParam());
  testing::play(
      simulation, 0.0, 0.4, 1000.0,
      [](double t) { return lying(0, t < 0.2 ? 0.002 - 0.02 * t : -0.002 + 2.0 * (t - 0.2)); },
      [](const Simulation& s) { EXPECT_LE(total_force(s).z(), 0.0); });
}

TEST_P(SprungModel, a_sliding_phalanx_drags_with_dynamic_friction) {
  Simulation simulation = fixed_block(GetParam());
  const Material material = simulation.scene().bodies[0].material;
  testing::play(simulation, 0.0, 0.5, 1000.0, [](double t) {
    return lying(0.1 * std::max(0.0, t - 0.2), std::max(-0.002, 0.002 - 0.04 * t));
  });
  const Vector3 force = total_force(simulation);
  EXPECT_NEAR(force.x(), -material.dynamic_friction * force.z(), 1e-9);
  EXPECT_LE(std::abs(force.y()), 1e-9);
}

TEST_P(SprungModel, forces_stay_in_the_friction_cone) {
  PinchedCube pinch(GetParam());
  const double mu = pinch.body().material.static_friction;
  int pressed = 0, slipped = 0;
  // 0.1 kg at 9 g asks for more than friction gives.
  pinch.play(
      1.0, [](double t) -> Vector3 { return testing::swing(std::max(0.0, t - 0.4), 0.1, 4.8); },
      [&] {
        for (const Contact& contact : pinch.simulation().state().contacts) {
          const double push = -contact.normal.dot(contact.force);
          EXPECT_GE(push, -1e-12);
          EXPECT_LE((contact.force + push * contact.normal).norm(), mu * push + 1e-12);
          pressed += push > 0.0;
          slipped += contact.friction == Friction::slipping;
        }
      });
  EXPECT_GT(pressed, 500);
  EXPECT_GT(slipped, 20);
}

TEST_P(SprungModel, a_still_hand_on_or_beside_a_resting_object_moves_nothing) {
  for (const double gap : {0.01, 1e-6}) {
    Simulation simulation(testing::scene_of(testing::box_body(Vector3::Constant(0.05), 0.1)),
                          PinchedCube::configuration_of(GetParam(), Vector3::Zero()));
    testing::play(simulation, 0.0, 1.0, 120.0, [&](double) { return lying(0, 0.025 + gap); });
    EXPECT_EQ(kinetic_energy(simulation.scene().bodies[0], simulation.state().bodies[0]), 0.0) << gap;
  }
}

TEST_P(SprungModel, a_ball_that_bounces_off_a_still_finger_never_gains) {
  Body ball = testing::ball_body(0.03, 0.06);
  ball.material.stiffness = default_material(testing::unfiltered(GetParam())).stiffness;
  ball.start_twist.linear = Vector3(0.01, 0, -0.5);
  ball.start.position = Vector3(0, 0.003, 0.1);
  Simulation simulation(testing::scene_of(ball), PinchedCube::configuration_of(GetParam(), Vector3::Zero()));
  const auto energy = [&] {
    return kinetic_energy(simulation.scene().bodies[0], simulation.state().bodies[0]);
  };
  const double first = energy();
  testing::play(
      simulation, 0.0, 0.6, 1000.0, [](double) { return lying(0, -2.0 * kTipRadius); },
      [&](const Simulation&) { EXPECT_LE(energy(), first * (1.0 + 1e-12)); });
  EXPECT_GT(object_twist(simulation).linear.z(), 0.05);
  EXPECT_LT(energy(), 0.9 * first);
}

TEST_P(SprungModel, a_held_cube_that_is_pushed_comes_to_rest) {
  PinchedCube pinch(GetParam());
  pinch.hold(1.0);
  const Vector3 seat = pinch.cube().pose.position;
  pinch.push(Vector3(0.002, 0.0, 0.002));
  pinch.hold(2.0);
  EXPECT_LE(pinch.energy(), 1e-12);
  EXPECT_LE((pinch.cube().pose.position - seat).norm(), 1e-6);
}

TEST_P(SprungModel, opening_lets_the_cube_go) {
  PinchedCube pinch(GetParam());
  pinch.open_at(1.0, 0.3);
  pinch.hold(1.5);
  EXPECT_TRUE(pinch.simulation().result().contacts.empty());
  EXPECT_LE(object_twist(pinch.simulation()).linear.norm(), 0.05);
}

INSTANTIATE_TEST_SUITE_P(Each, SprungModel,
                         ::testing::Values(ContactModelKind::virtual_spring, ContactModelKind::soft_pad),
                         [](const auto& each) {
                           return each.param == ContactModelKind::soft_pad ? "soft_pad" : "virtual_spring";
                         });

}  // namespace
}  // namespace mrhi
