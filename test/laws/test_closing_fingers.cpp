#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/reaching_hand.h"

namespace mrhi {
namespace {

/// Adds three fingertips under a horizontal face at height `z`, 12 mm and more from its middle, in the first
/// tenth of a second 2 mm lower: a hand that appears in a body does not touch it.
void carry_from_below(Hand& hand, double t, double z) {
  if (t < 0.1) z -= 0.002;
  const double x[] = {0.012, -0.012, 0.0}, y[] = {-0.008, -0.008, 0.014};
  for (const int finger : {2, 3, 4})
    testing::add_fingertip(hand, capsule_index(finger, 3), Vector3(x[finger - 2], y[finger - 2], z),
                           -Vector3::UnitZ(), 1.0, Vector3::UnitY());
}

/// The cube at 1 g.
Scene heavy_cube(double friction) {
  Body cube = testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 0.3);
  cube.material.static_friction = cube.material.dynamic_friction = friction;
  Scene scene = testing::scene_of(cube);
  scene.gravity = Vector3(0, 0, -9.81);
  return scene;
}

// The thumb comes down from above as the fingers come up by 2 cm, so they close on the cube. They lift it a
// little before they are seen to close.
TEST(GraspAssist, closing_fingers_carry_what_lies_on_them_and_do_not_lift_it) {
  constexpr double kUp = 0.02, kClosed = 0.45;
  Simulation simulation(heavy_cube(0.8), Configuration());
  bool closes = false;
  const auto hand_at = [](double t) {
    Hand hand = testing::empty_hand();
    const double closed = std::min(std::max(0.0, t - 0.25) / 0.2, 1.0);
    testing::add_fingertip(hand, capsule_index(0, 3),
                           Vector3(0, 0, testing::kReachedHalf + 0.06 - 0.03 * closed), Vector3::UnitZ());
    carry_from_below(hand, t, -testing::kReachedHalf + kUp * closed);
    return hand;
  };
  testing::play(simulation, 0.0, kClosed, 120.0, hand_at, [&](const Simulation& s) {
    for (const Contact& contact : s.state().contacts) closes = closes || contact.compliance > 0.0;
  });
  EXPECT_TRUE(closes);
  EXPECT_NEAR(simulation.state().bodies[0].pose.position.z(), 0.0, 0.005);
}

// Thumb and index hold the cube too slippery to carry it: it sinks by 5 mm onto three other fingers. They
// keep it as thumb and index let go.
TEST(GraspAssist, a_hand_that_releases_still_carries_what_lies_on_its_other_fingers) {
  constexpr double kDown = 0.005;
  Simulation simulation(heavy_cube(0.02), Configuration());
  bool supported = false, released = false;
  const auto hand_at = [](double t) {
    const double opened = 0.4 * testing::smooth(t - 0.9, 0.3);
    Hand hand = testing::reaching(std::min(t / 0.2, 1.0) - opened, 0.012, 0.0);
    carry_from_below(hand, t, -testing::kReachedHalf - kDown * testing::smooth(t - 0.3, 0.2));
    return hand;
  };
  testing::play(simulation, 0.0, 1.5, 120.0, hand_at, [&](const Simulation& s) {
    for (const Grip& grip : s.state().grips) {
      supported = supported || grip.active;
      released = released || grip.released;
    }
  });
  EXPECT_TRUE(supported);
  EXPECT_TRUE(released);
  EXPECT_NEAR(simulation.state().bodies[0].pose.position.z(), -kDown, 0.0015);
}

// The index arrives 1 cm before the thumb, at 0.4 m/s on average. A nanometre is rounding's part.
TEST(GraspAssist, a_closing_finger_moves_nothing_before_it_is_opposed) {
  constexpr double kAhead = 0.01, kClose = 0.0015;  // the thumb opposes from 1 mm on [m]
  for (const double step : {0.001, 1.0 / 120.0}) {
    Configuration configuration;
    configuration.step = step;
    Simulation simulation(
        testing::scene_of(testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 0.03)),
        configuration);
    double closed = 0.0;
    int touching = 0;
    testing::play(
        simulation, 0.0, 0.08, 120.0,
        [&](double t) {
          closed = std::min(t / 0.08, 1.0);
          return testing::reaching(closed, 0.012, kAhead);
        },
        [&](const Simulation& s) {
          const double thumb = (1.0 - closed) * testing::kFingersAway +
                               closed * (testing::kReachedHalf - 0.012) + kAhead - testing::kReachedHalf;
          if (thumb < kClose) return;
          touching += s.result().contacts.empty() ? 0 : 1;
          EXPECT_LT(s.state().bodies[0].pose.position.norm(), 1e-9) << step << ", " << 1e3 * thumb << " mm";
        });
    EXPECT_GT(touching, 0) << step;
  }
}

// The index snaps off the thumb's tip against a cube beyond it, which flies off as fast as without help.
TEST(GraspAssist, leaves_a_flick_what_it_is) {
  std::vector<double> speeds;
  for (const bool assist : {true, false}) {
    Configuration configuration = testing::implicit_configuration();
    configuration.contact.grasp_assist = assist;
    configuration.contact.hand = HandStrength::of_a_person();
    Simulation simulation(
        testing::scene_of(testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 0.05)),
        configuration);
    testing::play(
        simulation, 0.0, 0.6, 120.0,
        [&](double t) {
          Hand hand = testing::empty_hand();
          const double index = -0.045 + 0.04 * testing::smooth(t - 0.3, 0.05);
          testing::add_fingertip(hand, capsule_index(1, 3), Vector3(index, 0, 0), Vector3::UnitX(), 1.2);
          testing::add_fingertip(hand, capsule_index(0, 3), Vector3(-0.06, 0, 0), -Vector3::UnitX(), 1.2);
          return hand;
        },
        [&](const Simulation& s) { EXPECT_TRUE(s.state().grips.empty()); });
    speeds.push_back(testing::object_twist(simulation).linear.norm());
  }
  EXPECT_GT(speeds[0], 0.5);
  EXPECT_EQ(speeds[0], speeds[1]);
}

}  // namespace
}  // namespace mrhi
