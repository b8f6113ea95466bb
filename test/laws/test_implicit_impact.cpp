#include <gtest/gtest.h>

#include <algorithm>

#include "mr_hand_interaction/synthetic/random.h"
#include "support/slap.h"

namespace mrhi {
namespace {

using testing::blow;
using testing::hitter;
using testing::object_twist;
using testing::plates_hit;
using testing::play;
using testing::scene_of;
using testing::slab;

Configuration implicit(double step) {
  Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
  configuration.step = step;
  configuration.tracking.max_speed = 100.0;
  return configuration;
}

// Scene (c): closed form (1 + e) u, no spin.
TEST(ImplicitSlap, through_the_middle_gives_the_closed_forms_speed_and_no_spin) {
  for (const double restitution : {0.0, 0.5, 1.0}) {
    Simulation simulation(scene_of(slab(Vector3::Constant(0.05), restitution)), implicit(0.001));
    play(simulation, 0.0, 0.08, 1000.0, hitter(3.0, 0.025, 0.0503, Vector3::Zero()));
    const Twist twist = object_twist(simulation);
    const double expected = 3.0 * (1.0 + restitution);
    EXPECT_NEAR(twist.linear.x() / expected, 1.0, 1e-4) << restitution;
    EXPECT_LE(twist.angular.norm(), 0.005) << restitution;
  }
}

TEST(ImplicitSlap, off_centre_gives_the_closed_forms_velocity_and_spin) {
  for (const double mu : {0.8, 0.05, 0.0}) {
    for (const double lever : {0.005, 0.01, 0.02}) {
      Body body = slab(Vector3::Constant(0.05), 0.5);
      body.material.static_friction = mu;
      body.material.dynamic_friction = mu;
      const Twist expected = blow(body, 3.0, 0.5, 0.025, lever);
      Simulation simulation(scene_of(body), implicit(0.001));
      play(simulation, 0.0, 0.054, 1000.0, hitter(3.0, 0.025, 0.0503, Vector3(0, 0, lever)));
      const Twist twist = object_twist(simulation);
      EXPECT_LE((twist.linear - expected.linear).norm(), 1e-3 * expected.linear.norm()) << mu << " " << lever;
      EXPECT_LE((twist.angular - expected.angular).norm(), 1e-3 * expected.angular.norm())
          << mu << " " << lever;
    }
  }
}

// Scene (c) at one step per frame, restitution 0: the capsule moves by ten plates' thickness in a step.
TEST(ImplicitPlate, is_hit_in_every_phase_at_one_step_per_frame) {
  EXPECT_EQ(plates_hit(3.0, 120.0, implicit(0.05)), 25);
  EXPECT_EQ(plates_hit(10.0, 60.0, implicit(0.05)), 25);
}

TEST(ImplicitPlate, is_not_pushed_before_it_is_met) {
  Simulation simulation(scene_of(slab(Vector3(0.005, 0.1, 0.1), 0.0)), implicit(0.05));
  play(simulation, 0.0, 0.1, 120.0, hitter(3.0, 0.0025, 0.046, Vector3::Zero()), [](const Simulation& s) {
    const double met = 0.046, now = to_seconds(s.result().stamp - testing::kStart);
    const double expected = now < met ? 0.0 : 3.0 * (now - met);
    EXPECT_NEAR(s.state().bodies[0].pose.position.x(), expected, 1e-5) << now;
  });
}

TEST(ImplicitPlate, a_capsule_that_passes_by_does_not_touch_it) {
  Simulation simulation(scene_of(slab(Vector3(0.005, 0.1, 0.1), 0.0)), implicit(0.05));
  play(simulation, 0.0, 0.2, 60.0,
       hitter(10.0, 0.0025, 0.1, Vector3(0, 0, 0.05 + testing::kHitterRadius + 0.001)));
  EXPECT_EQ(object_twist(simulation).linear.norm(), 0.0);
}

// What rests 0.3 mm behind it is struck by it in the same step.
TEST(ImplicitSlap, sends_no_box_into_the_one_behind_it) {
  Scene scene = scene_of(slab(Vector3::Constant(0.05), 1.0));
  Body behind = slab(Vector3::Constant(0.05), 1.0);
  behind.name = "behind";
  behind.start.position.x() = 0.0503;
  scene.bodies.push_back(behind);
  Simulation simulation(scene, implicit(0.001));
  double deepest = -1.0;
  play(simulation, 0.0, 0.08, 1000.0, hitter(3.0, 0.025, 0.0503, Vector3::Zero()), [&](const Simulation& s) {
    const auto& bodies = s.state().bodies;
    deepest = std::max(deepest, 0.05 - (bodies[1].pose.position.x() - bodies[0].pose.position.x()));
  });
  // A hand's blow and what it sends on are dealt with at once: the second has no restitution.
  EXPECT_GT(object_twist(simulation, 1).linear.x(), 2.99);
  EXPECT_LT(deepest, 1e-5);
}

/// Newton's restitution together with friction alone would make up to half of it more here. A body turns on
/// within the step in which it is struck, which is worth up to 0.08 % at this one, and less at shorter ones.
TEST(ImplicitImpact, a_body_that_spins_against_a_finger_that_is_still_never_leaves_with_more_energy) {
  int struck = 0;
  for (const double restitution : {0.3, 0.8, 1.0}) {
    for (std::uint64_t seed = 0; seed < 100; ++seed) {
      Random random(seed);
      Body body = slab(Vector3(0.02, 0.05, 0.1), restitution);
      body.material.static_friction = body.material.dynamic_friction = 0.8;
      body.start = {Vector3(0.08, 0.0, 0.0),
                    Quaternion(Eigen::AngleAxisd(random.gaussian(), Vector3(0, 0.6, 0.8)))};
      body.start_twist = {Vector3(-1.0, 0.2 * random.gaussian(), 0.0), random.gaussian_vector(15.0)};
      Simulation simulation(scene_of(body), implicit(0.0001));
      const auto energy = [&] {
        return kinetic_energy(simulation.scene().bodies[0], simulation.state().bodies[0]);
      };
      const double before = energy();
      const Hand still = testing::finger(Vector3(-0.01, -0.2, 0.0), Vector3(-0.01, 0.2, 0.0), 0.008);
      play(simulation, 0.0, 0.3, 120.0, [&](double) { return still; });
      struck += std::abs(energy() / before - 1.0) > 1e-6;
      EXPECT_LE(energy(), before * 1.002) << restitution << " " << seed;
    }
  }
  EXPECT_GT(struck, 100);
}

/// The body over a floor at height 0, at 1 g.
Scene over_floor(const Body& body) {
  Body floor = testing::box_body(Vector3(4.0, 4.0, 0.1), 1.0);
  floor.name = "floor", floor.fixed = true;
  floor.start.position = Vector3(0, 0, -0.05);
  Scene scene;
  scene.gravity = Vector3(0, 0, -9.81);
  scene.bodies = {floor, body};
  return scene;
}

/// A frame of this length is one step, whatever its rounding.
Configuration falling(const Scene& scene, double step) {
  Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
  configuration.step = 1.001 * step;
  configuration.gravity = scene.gravity;
  return configuration;
}

// From one corner it swings down on the others, within the step or later, sometimes faster than it fell.
TEST(ImplicitImpact, a_brick_that_lands_on_a_corner_sinks_in_with_none_of_the_others) {
  using StepAndDepth = std::pair<double, double>;
  const Vector3 size(0.08, 0.04, 0.03);
  for (const auto& [step, depth] : {StepAndDepth{0.001, 5e-4}, {1.0 / 120.0, 3e-3}}) {
    for (int fall = 0; fall < 400; ++fall) {
      Body brick = testing::box_body(size, 2000.0 * size.prod());
      brick.start.position = Vector3(0, 0, 0.06 + 0.0005 * fall);
      const Vector3 axis(std::cos(fall), std::sin(fall), 0.0);
      brick.start.orientation = Quaternion(Eigen::AngleAxisd(0.001 + 0.002 * (fall % 50), axis));
      brick.material.restitution = 0.4 * (fall % 3);
      const Scene scene = over_floor(brick);
      Simulation simulation(scene, falling(scene, step));
      double deepest = 0.0;
      for (int i = 0; i * step <= 0.6; ++i) {
        simulation.advance({testing::at(i * step), {}});
        const Pose& pose = simulation.state().bodies[1].pose;
        const Matrix3 turned = pose.orientation.toRotationMatrix();
        deepest = std::max(deepest, 0.5 * turned.row(2).cwiseAbs().dot(size) - pose.position.z());
      }
      EXPECT_LT(deepest, depth) << "steps of " << step << " s, fall " << fall;
    }
  }
}

// Steel rods that land on an end get a spin about their own axis that is a thousand times easier to change
// than one across: solved by the inertia of another time, impacts once gave back three times the energy, or
// 1e6 times.
TEST(ImplicitImpact, a_slender_rod_that_falls_gains_no_energy) {
  struct Rods {
    double step, breadth;
    int gaining;  // at most: springs of a step with an impact know the rod as it was before
  };
  for (const Rods& rods : {Rods{1.0 / 120.0, 0.005, 0}, {1.0 / 120.0, 0.001, 3}, {0.002, 0.001, 0}}) {
    const double breadth = rods.breadth;
    int gaining = 0;
    Random random(1);
    for (int fall = 0; fall < 200; ++fall) {
      Body rod = testing::box_body(Vector3(breadth, breadth, 0.3), 7800.0 * breadth * breadth * 0.3);
      rod.start.position = Vector3(0, 0, 0.3);
      rod.start.orientation = Quaternion(Eigen::AngleAxisd(2.0 * random.uniform() - 1.0, Vector3::UnitX())) *
                              Quaternion(Eigen::AngleAxisd(2.0 * random.uniform() - 1.0, Vector3::UnitY()));
      const Scene scene = over_floor(rod);
      Simulation simulation(scene, falling(scene, rods.step));
      const auto energy = [&] {
        const BodyState& state = simulation.state().bodies[1];
        return kinetic_energy(rod, state) + 9.81 * rod.mass * state.pose.position.z();
      };
      const double start = energy();
      double highest = start;
      for (int i = 0; i <= 100; ++i) {
        simulation.advance({testing::at(i / 120.0), {}});
        highest = std::max(highest, energy());
      }
      gaining += highest > 1.001 * start;
      EXPECT_LT(highest, 2.0 * start) << breadth << " m, steps of " << rods.step << " s, fall " << fall;
    }
    EXPECT_LE(gaining, rods.gaining) << breadth << " m, steps of " << rods.step << " s";
  }
}

}  // namespace
}  // namespace mrhi
