#include <gtest/gtest.h>

#include "support/joints.h"

namespace mrhi {
namespace {

using namespace testing;

/// A block of 1 kg on a vertical rail, up is positive; or a rod on a hinge.
Scene rail(double gravity) {
  Scene scene;
  scene.name = "rail";
  scene.gravity = {0, 0, -gravity};
  Body block = box_body({0.1, 0.1, 0.1}, 1.0);
  block.name = "block";
  scene.bodies.push_back(block);
  Joint joint = hinge(Joint::kWorld, 0, {}, {});
  joint.name = "rail";
  joint.kind = JointKind::sliding;
  joint.axis = Vector3::UnitZ();
  scene.joints.push_back(joint);
  return scene;
}

Simulation running(const Scene& scene, double step = 0.001) {
  Configuration configuration = unfiltered(ContactModelKind::implicit);
  configuration.step = step;
  return Simulation(scene, configuration);
}

double position(const Simulation& simulation) {
  return simulation.state().joints[0].position;
}
double speed(const Simulation& simulation) {
  return joint_velocity(simulation.scene(), 0, simulation.state().bodies);
}
int count(const Simulation& simulation, EventKind kind) {
  int events = 0;
  for (const Event& event : simulation.result().events) events += event.kind == kind;
  return events;
}

TEST(JointLimit, holds_without_a_bounce_and_is_told_once) {
  for (const double step : {0.001, 0.0083}) {
    Scene scene = rail(9.81);
    scene.joints[0].lower = -0.1;
    scene.joints[0].upper = 0.1;
    Simulation simulation = running(scene, step);
    int told = 0;
    double deepest = 0.0, highest = -1.0;
    bool reached = false;
    let_go_on(simulation, 0.0, 2.0, 120.0, [&](const Simulation& now) {
      told += count(now, EventKind::joint_limit);
      deepest = std::max(deepest, -0.1 - position(now));
      reached = reached || told > 0;
      if (reached) highest = std::max(highest, position(now));
    });
    EXPECT_EQ(told, 1) << step;
    EXPECT_LT(deepest, 1e-6) << step;  // the limit's spring
    EXPECT_LT(highest, -0.1 + 1e-6) << step;
    EXPECT_LT(std::abs(speed(simulation)), 1e-9) << step;
  }
}

TEST(JointLimit, is_not_reached_by_what_was_at_it_from_the_start) {
  Scene scene = rail(9.81);
  scene.joints[0].lower = -5e-6;  // a model whose start is its limit but for rounding in its file
  Simulation simulation = running(scene);
  int told = 0;
  let_go_on(simulation, 0.0, 0.5, 120.0,
            [&](const Simulation& now) { told += count(now, EventKind::joint_limit); });
  EXPECT_EQ(told, 0);
  EXPECT_NEAR(position(simulation), -5e-6, 1e-6);
}

// It rises by 46 um and falls back.
TEST(JointLimit, is_not_reached_again_by_what_has_hardly_left_it) {
  Scene scene = rail(9.81);
  scene.joints[0].lower = 0.0;
  scene.bodies[0].start_twist.linear = {0, 0, 0.03};
  Simulation simulation = running(scene);
  int events = 0;
  double highest = 0.0;
  let_go_on(simulation, 0.0, 0.5, 1000.0, [&](const Simulation& now) {
    events += count(now, EventKind::joint_limit);
    highest = std::max(highest, position(now));
  });
  EXPECT_GT(highest, 3e-5);
  EXPECT_EQ(events, 0);
}

/// The fall's speed at the limit is known; within a step of 1 ms gravity adds 0.01 m/s.
TEST(JointLimit, bounces_by_its_restitution) {
  Scene scene = rail(9.81);
  scene.joints[0].lower = -0.2;
  scene.joints[0].restitution = 0.5;
  Simulation simulation = running(scene);
  double before = 0.0, after = 0.0;
  let_go_on(simulation, 0.0, 0.3, 1000.0, [&](const Simulation& now) {
    before = std::min(before, speed(now));
    after = std::max(after, speed(now));
  });
  EXPECT_NEAR(before, -std::sqrt(2.0 * 9.81 * 0.2), 0.02);
  EXPECT_NEAR(after, -0.5 * before, 0.03);
}

/// At a step in which its spring's force changes much, a bounce all the same gives nothing that was not
/// there: it is dealt as a blow, whose impulse the spring then finds, and not as a place to be sprung to.
TEST(JointLimit, gives_no_energy_where_a_spring_pushes_against_the_bounce) {
  for (const double step : {0.001, 0.0083, 0.02}) {
    Scene scene = rail(0.0);
    scene.joints[0].lower = -0.1;
    scene.joints[0].restitution = 1.0;
    scene.joints[0].spring = JointSpring{200.0, -0.5};
    scene.bodies[0].start_twist.linear = {0, 0, -3.0};
    Simulation simulation = running(scene, step);
    const auto energy = [](const Simulation& now) {
      return 0.5 * speed(now) * speed(now) + 100.0 * std::pow(position(now) + 0.5, 2);
    };
    const double before = energy(simulation);
    int bounces = 0;
    double last = -1.0, most = 0.0;
    let_go_on(simulation, 0.0, 0.3, 1.0 / step, [&](const Simulation& now) {
      bounces += speed(now) * last < 0.0;
      last = speed(now);
      most = std::max(most, energy(now));
    });
    EXPECT_GE(bounces, 2) << step;
    EXPECT_LE(most, before * (1.0 + 1e-6)) << step;
  }
}

/// A block that is whirled about slides out to its limit and, as it swings on within each step, some way
/// beyond. A step that is far shorter does not throw it back all that way at once.
TEST(JointLimit, lets_what_has_swung_beyond_it_come_back_no_faster_in_a_short_step) {
  constexpr double kSpin = 20.0, kArm = 0.2, kStep = 0.0083;  // [rad/s], [m], [s]
  Scene scene = rail(0.0);
  scene.joints[0].kind = JointKind::turning;
  Body sliding = box_body({0.05, 0.05, 0.05}, 0.1);
  sliding.name = "sliding";
  sliding.start.position = {kArm, 0, 0};
  scene.bodies.push_back(sliding);
  Joint radial = hinge(0, 1, {{kArm, 0, 0}, Quaternion::Identity()}, {});
  radial.name = "radial";
  radial.kind = JointKind::sliding;
  radial.axis = Vector3::UnitX();
  radial.upper = 0.0;
  scene.joints.push_back(radial);
  scene.bodies[0].start_twist.angular = scene.bodies[1].start_twist.angular = {0, 0, kSpin};
  scene.bodies[1].start_twist.linear = {0, kSpin * kArm, 0};
  Simulation simulation = running(scene, kStep);
  let_go_on(simulation, 0.0, 0.2, 1.0 / kStep);
  const double beyond = simulation.state().joints[1].position;
  EXPECT_GT(beyond, 1e-4);
  let_go_on(simulation, 0.2005, 0.2005, 1000.0);
  const double inwards = -joint_velocity(simulation.scene(), 1, simulation.state().bodies);
  EXPECT_GT(inwards, 0.0);
  EXPECT_LT(inwards, 1.5 * beyond / kStep);
}

/// Ten minutes under three quarters of what it bears.
TEST(JointFriction, holds_without_creep) {
  Scene scene = rail(9.81);
  scene.joints[0].friction = 13.0;
  Simulation simulation = running(scene, 0.0083);
  let_go_on(simulation, 0.0, 1.0, 120.0);
  const double settled = position(simulation);
  let_go_on(simulation, 1.1, 600.0, 60.0);
  EXPECT_NEAR(settled, 0.0, 1e-6);
  EXPECT_NEAR(position(simulation), settled, 1e-9);
}

TEST(JointFriction, slides_with_what_is_left) {
  Scene scene = rail(9.81);
  scene.joints[0].friction = 5.0;
  Simulation simulation = running(scene);
  let_go_on(simulation, 0.0, 0.3, 1000.0);
  EXPECT_NEAR(speed(simulation), -(9.81 - 5.0) * 0.3, 0.01);
}

TEST(JointDamping, slows_exponentially) {
  Scene scene = rail(0.0);
  scene.joints[0].damping = 2.0;
  scene.bodies[0].start_twist.linear = {0, 0, 0.5};
  Simulation simulation = running(scene);
  let_go_on(simulation, 0.0, 1.0, 1000.0);
  EXPECT_NEAR(speed(simulation), 0.5 * std::exp(-2.0), 5e-4);  // solved at steps' ends: first order
  EXPECT_NEAR(position(simulation), 0.25 * (1.0 - std::exp(-2.0)), 5e-4);
}

TEST(JointSpring, comes_to_rest_where_forces_balance_and_sleeps) {
  Scene scene = rail(9.81);
  scene.joints[0].spring = JointSpring{100.0, 0.05};
  scene.joints[0].damping = 20.0;
  Simulation simulation = running(scene);
  let_go_on(simulation, 0.0, 6.0, 60.0);
  EXPECT_NEAR(position(simulation), 0.05 - 9.81 / 100.0, 1e-6);
  EXPECT_TRUE(simulation.state().bodies[0].linear_momentum.isZero(0.0));
}

TEST(JointDetents, draw_to_the_nearest_and_click) {
  Scene scene = rail(0.0);
  scene.joints[0].detents = Detents{{-0.02, 0.0, 0.02}, 2.0};
  scene.joints[0].damping = 5.0;
  scene.bodies[0].start_twist.linear = {0, 0, 0.3};
  Simulation simulation = running(scene);
  int clicks = 0;
  let_go_on(simulation, 0.0, 5.0, 100.0,
            [&](const Simulation& now) { clicks += count(now, EventKind::detent); });
  EXPECT_NEAR(position(simulation), 0.02, 1e-6);
  EXPECT_EQ(clicks, 1);
}

TEST(JointLatch, holds_up_to_its_force) {
  for (const double gravity : {9.0, 11.0}) {
    Scene scene = rail(gravity);
    scene.joints[0].latch = Latch{0.0, 10.0, 0.003};
    scene.joints[0].lower = -0.1;
    Simulation simulation = running(scene);
    int opened = 0;
    let_go_on(simulation, 0.0, 2.0, 100.0,
              [&](const Simulation& now) { opened += count(now, EventKind::latch_open); });
    EXPECT_EQ(opened, gravity > 10.0 ? 1 : 0);
    EXPECT_NEAR(position(simulation), gravity > 10.0 ? -0.1 : 0.0, 1e-6);
  }
}

/// As a drawer that is closed: what stops it is its end.
TEST(JointLatch, catches_what_comes_back) {
  Scene scene = rail(0.0);
  scene.joints[0].lower = 0.0;
  scene.joints[0].latch = Latch{0.0, 10.0, 0.003};
  scene.joints[0].start = 0.05;
  scene.bodies[0].start_twist.linear = {0, 0, -0.1};
  Simulation simulation = running(scene);
  let_go_on(simulation, 0.0, 2.0, 100.0);
  EXPECT_TRUE(simulation.state().joints[0].latched);
  EXPECT_NEAR(position(simulation), 0.0, 1e-5);
}

/// A drawer on a rail, with a thousand times its mass hung from it on a hinge, both against a limit.
TEST(JointLimit, holds_a_thousand_times_the_mass) {
  Scene scene = rail(9.81);
  scene.joints[0].lower = 0.0;
  Body weight = box_body({0.3, 0.3, 0.3}, 1000.0);
  weight.name = "weight";
  scene.bodies.push_back(weight);
  scene.joints.push_back(
      hinge(0, 1, {{0, 0, -0.05}, Quaternion::Identity()}, {{0, 0, 0.3}, Quaternion::Identity()}, 0.3));
  scene.joints[1].damping = 50.0;
  Simulation simulation = running(scene, 0.0083);
  let_go_on(simulation, 0.0, 20.0, 60.0);
  EXPECT_NEAR(position(simulation), 0.0, 1e-3);
  EXPECT_LT(apart(simulation, 1).place, 1e-12);
  EXPECT_LT(std::abs(simulation.state().joints[1].position), 0.31);
}

}  // namespace
}  // namespace mrhi
