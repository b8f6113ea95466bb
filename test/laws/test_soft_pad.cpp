#include <gtest/gtest.h>

#include <array>

#include "../../src/response/soft_pad_model.h"
#include "support/pinched_cube.h"

namespace mrhi {
namespace {

using testing::finger;
using testing::fixed_block;
using testing::object_twist;
using testing::PinchedCube;
using testing::smooth;
using testing::total_force;

constexpr ContactModelKind kModel = ContactModelKind::soft_pad;
constexpr double kRadius = 0.008;
constexpr double kPitch = SoftPadModel::kSpacing * kRadius;
constexpr double kPadStiffness = SoftPadModel::kStiffness / (SoftPadModel::kAlong * SoftPadModel::kAcross);

/// A fingertip that lies on the plane z along x, 20 mm from end to end of its axis.
Hand lying(double x, double z) {
  return finger(Vector3(x - 0.01, 0, z + kRadius), Vector3(x + 0.01, 0, z + kRadius), kRadius);
}
/// One that stands on its tip, its axis tilted by `tilt` [rad] towards x.
Hand standing(double z, double tilt) {
  const Vector3 tip(0, 0, z + kRadius);
  return finger(tip + 0.025 * Vector3(std::sin(tilt), 0, std::cos(tilt)), tip, kRadius);
}

double sag(double off) {
  return off < kRadius ? kRadius - std::sqrt(kRadius * kRadius - off * off) : 1.0;
}

/// Sum of the depths of the pads about one end of a lying fingertip, its axis `depth` deep.
double depths_about_an_end(double depth) {
  double sum = 0.0;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -1; j <= 1; ++j) {
      const double beyond = std::max(0.0, i * kPitch);
      sum += std::max(0.0, depth - sag(std::hypot(beyond, j * kPitch)));
    }
  }
  return sum;
}

Vector3 pressed(const std::function<Hand(double)>& tip, double depth, Simulation simulation) {
  testing::play(simulation, 0.0, 0.3, 1000.0,
                [&](double t) { return tip(0.002 - (depth + 0.002) * smooth(t, 0.2)); });
  return total_force(simulation);
}

TEST(SoftPad, force_at_rest_is_that_of_all_pads_under_a_lying_fingertip) {
  for (const double depth : {0.0005, 0.002, 0.006}) {
    const Vector3 force = pressed([](double z) { return lying(0, z); }, depth, fixed_block(kModel));
    const double expected = kPadStiffness * depths_about_an_end(depth);  // two ends, each half of the load
    EXPECT_NEAR(force.z(), -expected, 1e-9 * expected) << depth;
    EXPECT_LE(force.head<2>().norm(), 1e-9 * expected);
  }
}

TEST(SoftPad, force_at_rest_is_that_of_all_pads_under_a_standing_fingertip) {
  double expected = 0.0;
  for (int i = -2; i <= 2; ++i) {
    for (int j = -1; j <= 1; ++j)
      expected += kPadStiffness * std::max(0.0, 0.004 - sag(std::hypot(i * kPitch, j * kPitch)));
  }
  for (const double tilt : {0.0, 0.02}) {
    const Vector3 force = pressed([tilt](double z) { return standing(z, tilt); }, 0.004, fixed_block(kModel));
    EXPECT_NEAR(force.z(), -expected, 1e-9 * expected) << tilt;
  }
}

TEST(SoftPad, pads_beside_a_narrow_object_do_not_press) {
  // 6 mm wide: the middle row only.
  double expected = 0.0;
  for (int i = -2; i <= 2; ++i)
    expected += kPadStiffness * std::max(0.0, 0.002 - sag(std::max(0.0, i * kPitch)));
  const Vector3 force =
      pressed([](double z) { return lying(0, z); }, 0.002, fixed_block(kModel, Vector3(0.2, 0.006, 0.1)));
  EXPECT_NEAR(force.z(), -expected, 1e-9);
}

TEST(SoftPad, carries_a_pinched_cube_along) {
  PinchedCube pinch(kModel);
  const Vector3 way(0.05, 0.03, 0.1);
  pinch.hold(1.0);
  const Vector3 before = pinch.cube().pose.position;
  pinch.play(4.0, [&](double t) -> Vector3 { return smooth(t - 1.0, 1.0) * way; });
  // The greatest force of this way, 0.07 N, is a twentieth of what friction gives: nothing slips for good.
  EXPECT_LE((pinch.cube().pose.position - before - way).norm(), 1e-6);
  EXPECT_LE(pinch.energy(), 1e-12);
}

/// Where the cube is after 3 s and after 9 s of a pull of `force` [N] along the fingers that grows within 1
/// s.
std::array<double, 2> sunk(double force) {
  PinchedCube pinch(kModel, Vector3::Zero(), 0.003);
  pinch.hold(1.0);
  const double before = pinch.cube().pose.position.z();
  std::array<double, 2> result{};
  for (int i = 1; i <= 9000; ++i) {
    const double t = i / PinchedCube::kRate;
    pinch.push(Vector3(0, 0, -force * smooth(t, 1.0) / PinchedCube::kRate));
    pinch.hold(1.0 + t);
    if (i % 3000 == 0 && i != 6000) result[i / 9000] = before - pinch.cube().pose.position.z();
  }
  return result;
}

// Friction gives 2.1 N here. At 1.4 N the pads that press less are at their limit already, which shows in the
// cube's giving way by more than twice what it does at half of that.
TEST(SoftPad, does_not_creep_while_its_outer_pads_slip) {
  const std::array<double, 2> half = sunk(0.7), whole = sunk(1.4);
  EXPECT_GT(whole[0], 2.1 * half[0]);
  EXPECT_NEAR(whole[1], whole[0], 1e-9);
  EXPECT_NEAR(half[1], half[0], 1e-9);
}

/// How far a bar turns that two standing fingertips pinch at its middle, when it is given 0.5 rad/s about the
/// line between them: the most within 2.5 s [rad].
double turn_of_a_pinched_bar(ContactModelKind model) {
  Body bar = testing::box_body(Vector3(0.2, 0.02, 0.02), 0.05);
  bar.material.stiffness = SoftPadModel::kStiffness;
  Simulation simulation(testing::scene_of(bar), PinchedCube::configuration_of(model, Vector3::Zero()));
  const auto hand = [](double t) {
    const double z = 0.012 - 0.004 * smooth(t, 0.2) + kRadius;
    Hand tips = finger(Vector3(0, 0, z + 0.025), Vector3(0, 0, z), kRadius);
    testing::add_finger(tips, capsule_index(0, 3), Vector3(0, 0, -z - 0.025), Vector3(0, 0, -z), kRadius);
    return tips;
  };
  testing::play(simulation, 0.0, 0.5, 1000.0, hand);
  SimulationState state = simulation.state();
  state.bodies[0].angular_momentum = simulation.scene().bodies[0].inertia * Vector3(0, 0, 0.5);
  simulation.set_state(state);
  double most = 0.0;
  testing::play(simulation, 0.501, 3.0, 1000.0, hand, [&most](const Simulation& s) {
    most = std::max(most, s.state().bodies[0].pose.orientation.angularDistance(Quaternion::Identity()));
  });
  return most;
}

// About each tip four pads, 4 mm from its middle, touch at 2 mm depth: a spring of 2*4*33 N/m*(4 mm)^2
// = 4.3e-3 N m/rad on 1.7e-4 kg m^2, which turns by 0.5 rad/s / 5.0 rad/s before it swings back.
TEST(SoftPad, two_fingertips_hold_a_bar_against_turning_as_points_cannot) {
  EXPECT_NEAR(turn_of_a_pinched_bar(kModel), 0.1, 0.01);
  EXPECT_GE(turn_of_a_pinched_bar(ContactModelKind::virtual_spring), 1.2);
}

TEST(SoftPad, a_sliding_phalanx_drags_with_dynamic_friction) {
  Simulation simulation = fixed_block(kModel);
  const Material material = simulation.scene().bodies[0].material;
  testing::play(simulation, 0.0, 0.5, 1000.0, [](double t) {
    return lying(0.1 * std::max(0.0, t - 0.2), std::max(-0.002, 0.002 - 0.04 * t));
  });
  const Vector3 force = total_force(simulation);
  EXPECT_NEAR(force.x(), -material.dynamic_friction * force.z(), 1e-9);
  EXPECT_LE(std::abs(force.y()), 1e-9);
}

TEST(SoftPad, momentum_changes_by_the_forces_impulses) {
  PinchedCube pinch(kModel);
  Vector3 before = pinch.cube().linear_momentum;
  pinch.play(
      2.0, [](double t) -> Vector3 { return testing::swing(t, 0.02, 3.0); },
      [&] {
        const Vector3 impulse = total_force(pinch.simulation()) / PinchedCube::kRate;
        EXPECT_LE((pinch.cube().linear_momentum - before - impulse).norm(), 1e-14);
        before = pinch.cube().linear_momentum;
      });
}

TEST(SoftPad, forces_stay_in_the_friction_cone) {
  PinchedCube pinch(kModel);
  const double mu = pinch.body().material.static_friction;
  int pressed_often = 0, slipped = 0;
  // 0.1 kg at 9 g asks for more than friction gives.
  pinch.play(
      1.0, [](double t) -> Vector3 { return testing::swing(std::max(0.0, t - 0.4), 0.1, 4.8); },
      [&] {
        for (const Contact& contact : pinch.simulation().state().contacts) {
          const double push = -contact.normal.dot(contact.force);
          EXPECT_GE(push, -1e-12);
          EXPECT_LE((contact.force + push * contact.normal).norm(), mu * push + 1e-12);
          pressed_often += push > 0.0;
          slipped += contact.friction == Friction::slipping;
        }
      });
  EXPECT_GT(pressed_often, 500);
  EXPECT_GT(slipped, 20);
}

TEST(SoftPad, a_still_hand_on_or_beside_a_resting_object_moves_nothing) {
  for (const double gap : {0.01, 1e-6}) {
    Simulation simulation(testing::scene_of(testing::box_body(Vector3::Constant(0.05), 0.1)),
                          PinchedCube::configuration_of(kModel, Vector3::Zero()));
    testing::play(simulation, 0.0, 1.0, 120.0, [&](double) { return lying(0, 0.025 + gap); });
    EXPECT_EQ(kinetic_energy(simulation.scene().bodies[0], simulation.state().bodies[0]), 0.0) << gap;
  }
}

TEST(SoftPad, a_ball_that_bounces_off_a_still_finger_never_gains) {
  Body ball = testing::ball_body(0.03, 0.06);
  ball.material.stiffness = SoftPadModel::kStiffness;
  ball.start_twist.linear = Vector3(0.01, 0, -0.5);
  ball.start.position = Vector3(0, 0.003, 0.1);
  Simulation simulation(testing::scene_of(ball), PinchedCube::configuration_of(kModel, Vector3::Zero()));
  const auto energy = [&] {
    return kinetic_energy(simulation.scene().bodies[0], simulation.state().bodies[0]);
  };
  const double first = energy();
  testing::play(
      simulation, 0.0, 0.6, 1000.0, [](double) { return lying(0, -2.0 * kRadius); },
      [&](const Simulation&) { EXPECT_LE(energy(), first * (1.0 + 1e-12)); });
  EXPECT_GT(object_twist(simulation).linear.z(), 0.05);
  EXPECT_LT(energy(), 0.9 * first);
}

TEST(SoftPad, a_held_cube_that_is_pushed_comes_to_rest) {
  PinchedCube pinch(kModel);
  pinch.hold(1.0);
  const Vector3 seat = pinch.cube().pose.position;
  pinch.push(Vector3(0.002, 0.0, 0.002));
  pinch.hold(2.0);
  EXPECT_LE(pinch.energy(), 1e-12);
  EXPECT_LE((pinch.cube().pose.position - seat).norm(), 1e-6);
}

TEST(SoftPad, opening_lets_the_cube_go) {
  PinchedCube pinch(kModel);
  pinch.open_at(1.0, 0.3);
  pinch.hold(1.5);
  EXPECT_TRUE(pinch.simulation().result().contacts.empty());
  EXPECT_LE(object_twist(pinch.simulation()).linear.norm(), 0.05);
}

}  // namespace
}  // namespace mrhi
