#include <gtest/gtest.h>

#include "support/grips.h"

namespace mrhi {
namespace {

using testing::at;
using testing::ball_body;
using testing::box_body;
using testing::finger;
using testing::has_event;
using testing::object_twist;
using testing::play;
using testing::scene_of;
using testing::smooth;
using testing::unfiltered;

constexpr double kTipRadius = 0.008;
constexpr double kHalfEdge = 0.025;
constexpr double kOverlap = 0.004;

/// Two fingertips on either side of a cube along x: closed by 0.3 s, carried by `way` between 0.5 and 1.5 s,
/// opened from `open` on.
std::function<Hand(double)> pinch(const Vector3& way, double open) {
  return [=](double t) {
    const double gap = 0.01 - (0.01 + kOverlap) * smooth(t, 0.3) + 0.03 * smooth(t - open, 0.1);
    const Vector3 shift = smooth(t - 0.5, 1.0) * way;
    const Vector3 x((kHalfEdge + kTipRadius + gap), 0, 0), y(0, 0.0125, 0);
    Hand hand = finger(shift + x - y, shift + x + y, kTipRadius);
    testing::add_finger(hand, capsule_index(0, 3), shift - x - y, shift - x + y, kTipRadius);
    return hand;
  };
}

Body cube() {
  return box_body(Vector3::Constant(2.0 * kHalfEdge), 0.1);
}

double kinetic_energy_of_cube(const Simulation& simulation) {
  return kinetic_energy(simulation.scene().bodies[0], simulation.state().bodies[0]);
}

TEST(Hold, a_pinched_cube_follows_the_hand_and_is_reported_as_grasped) {
  Simulation simulation(scene_of(cube()), unfiltered());
  bool grasped = false;
  const Vector3 way(0.05, 0.03, 0.1);
  play(simulation, 0.0, 2.5, 120.0, pinch(way, 10.0),
       [&](const Simulation& s) { grasped = grasped || has_event(s, EventKind::grasp_begin); });
  EXPECT_TRUE(grasped);
  // 0.1 kg on four springs of 100 N/m at the accelerations of this motion (0.7 m/s^2) gives way by 0.3 mm;
  // what is left of that 1 s later is slip.
  EXPECT_LE((simulation.state().bodies[0].pose.position - way).norm(), 0.001);
  EXPECT_LE(kinetic_energy_of_cube(simulation), 1e-8);
}

TEST(Hold, a_held_cube_comes_to_rest_instead_of_ringing) {
  Simulation simulation(scene_of(cube()), unfiltered());
  play(simulation, 0.0, 0.6, 120.0, pinch(Vector3::Zero(), 10.0));
  BodyState pushed = simulation.state().bodies[0];
  pushed.linear_momentum = Vector3(0.002, 0.0, 0.002);  // 20 mm/s
  SimulationState state = simulation.state();
  state.bodies[0] = pushed;
  simulation.set_state(state);
  const double before = kinetic_energy_of_cube(simulation);
  play(simulation, 0.6 + 1.0 / 120, 1.6, 120.0, pinch(Vector3::Zero(), 10.0));
  EXPECT_LE(kinetic_energy_of_cube(simulation), 1e-3 * before);
}

TEST(Hold, opening_the_pinch_lets_the_cube_go_gently) {
  Simulation simulation(scene_of(cube()), unfiltered());
  play(simulation, 0.0, 1.0, 120.0, pinch(Vector3::Zero(), 0.6));
  EXPECT_LE(object_twist(simulation).linear.norm(), 0.005);
  EXPECT_TRUE(simulation.result().contacts.empty());
}

TEST(Hold, a_friction_force_stays_in_the_cone) {
  Simulation simulation(scene_of(cube()), unfiltered());
  const double mu = simulation.scene().bodies[0].material.static_friction;
  int seen = 0;
  play(simulation, 0.0, 2.0, 120.0, pinch(Vector3(0, 0, 0.6), 10.0), [&](const Simulation& s) {
    for (const Contact& contact : s.state().contacts) {
      const double push = -contact.normal.dot(contact.force);
      const double drag = (contact.force + push * contact.normal).norm();
      EXPECT_GE(push, 0.0);
      EXPECT_LE(drag, mu * push + 1e-12);
      ++seen;
    }
  });
  EXPECT_GT(seen, 500);
}

TEST(Hold, rendered_fingertips_stay_outside_however_deep_the_tracked_ones_are) {
  Simulation simulation(scene_of(cube()), unfiltered());
  double tracked_depth = 0.0;
  play(simulation, 0.0, 1.0, 120.0, pinch(Vector3::Zero(), 10.0), [&](const Simulation& s) {
    for (const Contact& contact : s.result().contacts) tracked_depth = std::max(tracked_depth, contact.depth);
    EXPECT_LE(s.deepest_rendered(), 1e-5);
  });
  EXPECT_GE(tracked_depth, 0.9 * kOverlap);
}

TEST(Energy, a_still_hand_beside_or_on_a_resting_object_moves_nothing) {
  for (const double gap : {0.01, 1e-6}) {
    Simulation simulation(scene_of(cube()), unfiltered());
    const double x = kHalfEdge + kTipRadius + gap;
    play(simulation, 0.0, 1.0, 120.0,
         [x](double) { return finger(Vector3(x, -0.01, 0), Vector3(x, 0.01, 0), kTipRadius); });
    EXPECT_EQ(kinetic_energy_of_cube(simulation), 0.0) << gap;
    EXPECT_EQ(simulation.state().bodies[0].pose.position, Vector3::Zero());
  }
}

TEST(Energy, a_ball_that_bounces_off_a_still_finger_never_gains) {
  for (const double restitution : {0.0, 0.3, 0.9}) {
    Body ball = ball_body(0.03, 0.06);
    ball.material.restitution = restitution;
    ball.start_twist.linear = Vector3(-1.0, 0, 0);
    ball.start.position = Vector3(0.1, 0.003, 0);
    Simulation simulation(scene_of(ball), unfiltered());
    double last = kinetic_energy_of_cube(simulation);
    play(
        simulation, 0.0, 0.3, 1000.0,
        [](double) { return finger(Vector3(0, -0.02, 0), Vector3(0, 0.02, 0), kTipRadius); },
        [&](const Simulation& s) {
          EXPECT_LE(kinetic_energy_of_cube(s), last * (1.0 + 1e-12));
          last = kinetic_energy_of_cube(s);
        });
    EXPECT_NEAR(object_twist(simulation).linear.x(), restitution, 0.02) << restitution;
  }
}

TEST(Appearing, a_hand_that_appears_inside_an_object_does_not_push_it_until_it_has_left) {
  Simulation simulation(scene_of(cube()), unfiltered());
  const auto inside = [](double t) {
    const double x = t < 0.5 ? 0.02 : 0.02 + 0.2 * (t - 0.5);
    return finger(Vector3(x, -0.01, 0), Vector3(x, 0.01, 0), kTipRadius);
  };
  play(simulation, 0.0, 1.0, 120.0, inside);
  EXPECT_EQ(kinetic_energy_of_cube(simulation), 0.0);
  // Out now; when it comes back it touches.
  play(simulation, 1.0 + 1.0 / 120, 1.5, 120.0, [](double t) {
    const double x = 0.12 - 0.3 * (t - 1.0);
    return finger(Vector3(x, -0.01, 0), Vector3(x, 0.01, 0), kTipRadius);
  });
  EXPECT_LT(object_twist(simulation).linear.x(), -0.1);
}

TEST(Appearing, a_hand_that_jumps_onto_an_object_leaves_it_in_peace) {
  Simulation simulation(scene_of(cube()), unfiltered());
  play(simulation, 0.0, 0.5, 120.0, [](double t) {
    const double x = t < 0.2 ? 0.33 : 0.03;
    return finger(Vector3(x, -0.01, 0), Vector3(x, 0.01, 0), kTipRadius);
  });
  EXPECT_LE(object_twist(simulation).linear.norm(), 1e-12);
}

// It appears a tenth of a millimetre from the cube's face, within the distance at which contacts are found.
TEST(Appearing, a_hand_that_appears_beside_an_object_pushes_it) {
  constexpr double kGap = 0.0001, kSpeed = 0.2;
  Simulation simulation(scene_of(cube()), unfiltered());
  play(simulation, 0.0, 0.2, 120.0, [](double t) {
    const double x = kHalfEdge + kTipRadius + kGap - kSpeed * t;
    return finger(Vector3(x, -0.01, 0), Vector3(x, 0.01, 0), kTipRadius);
  });
  EXPECT_LT(simulation.state().bodies[0].pose.position.x(), -0.5 * kSpeed * 0.2);
}

}  // namespace
}  // namespace mrhi
