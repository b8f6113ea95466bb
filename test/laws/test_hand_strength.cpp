#include <gtest/gtest.h>

#include "support/grips.h"
#include "support/slap.h"

namespace mrhi {
namespace {

Configuration with(const HandStrength& hand) {
  Configuration configuration = testing::implicit_configuration();
  configuration.contact.hand = hand;
  return configuration;
}

/// Force on a wide body of a fingertip that has come `depth` into it [N]. The body is so heavy, and the
/// fingertip so light as it strikes, that the body stays where it is.
double push_of_a_fingertip(double depth, HandStrength hand) {
  hand.finger_mass = 0.001;
  Simulation simulation(testing::scene_of(testing::stiff_box(Vector3::Constant(0.2), 1e5)), with(hand));
  testing::play(simulation, 0.0, 1.0, 120.0, [&](double t) {
    Hand fingertip = testing::empty_hand();
    const double gap = 0.005 - (0.005 + depth) * std::min(t / 0.5, 1.0);
    testing::add_fingertip(fingertip, capsule_index(1, 3), Vector3(0.1 + gap, 0, 0), Vector3::UnitX());
    return fingertip;
  });
  double force = 0.0;
  for (const Contact& contact : simulation.result().contacts) force += contact.force.norm();
  return force;
}

// Half the stiffness over the pad's depth squared, then the stiffness. 1 %: the body gives way a little.
TEST(HandStrength, a_pad_stiffens_with_depth) {
  HandStrength hand;
  hand.pad = 0.002;
  EXPECT_NEAR(push_of_a_fingertip(0.001, hand), 0.5, 0.005);
  EXPECT_NEAR(push_of_a_fingertip(0.002, hand), 2.0, 0.02);
  EXPECT_NEAR(push_of_a_fingertip(0.004, hand), 6.0, 0.06);
  hand.pad = 0.0;
  EXPECT_NEAR(push_of_a_fingertip(0.001, hand), 2.0, 0.02);
}

// Beyond its strength a fiftieth of the stiffness is left: 2000 N/m by 20 mm would be 40 N.
TEST(HandStrength, a_finger_gives_way_beyond_its_strength) {
  HandStrength hand;
  hand.finger = 10.0;
  EXPECT_NEAR(push_of_a_fingertip(0.004, hand), 8.0, 0.08);
  EXPECT_NEAR(push_of_a_fingertip(0.020, hand), 10.6, 0.106);
}

// Three phalanges of a finger that lie on a body have one finger's strength together.
TEST(HandStrength, is_shared_by_the_phalanges_of_a_finger) {
  HandStrength hand;
  hand.finger = 10.0;
  hand.finger_mass = 0.001;  // the blow does not drive the body off
  Simulation simulation(testing::scene_of(testing::stiff_box(Vector3::Constant(0.2), 1e5)), with(hand));
  testing::play(simulation, 0.0, 1.0, 120.0, [&](double t) {
    Hand finger = testing::empty_hand();
    const double gap = 0.005 - 0.017 * std::min(t / 0.5, 1.0);
    for (const int bone : {1, 2, 3})
      testing::add_flat_finger(finger, capsule_index(2, bone), Vector3(0.1 + gap, 0.03 * (bone - 2), 0),
                               Vector3::UnitX(), Vector3::UnitY());
    return finger;
  });
  double force = 0.0;
  for (const Contact& contact : simulation.result().contacts) force += contact.force.norm();
  EXPECT_NEAR(force, 10.0 + 0.02 * (3 * 2000.0 * 0.012 - 10.0), 0.2);
}

// Newton's law between two masses: a fiftieth of the hand's speed is left of a blow on fifty times its mass.
TEST(HandStrength, a_blow_has_the_mass_of_the_phalanx) {
  HandStrength hand;
  hand.finger_mass = 0.05;
  const auto speed = [&](double mass) {
    Simulation simulation(testing::scene_of(testing::stiff_box(Vector3::Constant(0.1), mass, 1.0)),
                          with(hand));
    Vector3 struck = Vector3::Zero();
    testing::play(
        simulation, 0.0, 0.1, 1000.0,
        [&](double t) {
          Hand finger = testing::empty_hand();
          testing::add_fingertip(finger, capsule_index(1, 3), Vector3(0.06 - t, 0, 0), Vector3::UnitX());
          return finger;
        },
        [&](const Simulation& s) {
          for (const Contact& contact : s.result().contacts) struck += contact.impulse;
        });
    return struck.norm() / mass;
  };
  const double e = Material().restitution;
  EXPECT_NEAR(speed(0.05), (1.0 + e) * 0.5, 0.01);
  EXPECT_NEAR(speed(2.5), (1.0 + e) * 0.05 / 2.55, 1e-3);
}

// A palm that lies flat touches with two points where it is near enough, and is one mass all the same:
// Newton's law between two masses of 0.4 kg, to the precision of the solver. The step of 0.1 ms brings the
// slow hand near enough before it hits.
TEST(HandStrength, all_points_of_a_flat_palm_have_its_mass_together) {
  HandStrength hand;
  hand.palm_mass = 0.4;
  constexpr double kSpeed = 0.2;
  Configuration configuration = with(hand);
  configuration.step = 0.0001;
  Simulation simulation(testing::scene_of(testing::stiff_box(Vector3::Constant(0.1), 0.4, 1.0)),
                        configuration);
  Vector3 struck = Vector3::Zero();
  int points = 0;
  testing::play(
      simulation, 0.0, 0.1, 1000.0,
      [&](double t) {
        Hand palm = testing::empty_hand();
        testing::add_flat_finger(palm, kPalm, Vector3(0.06 - kSpeed * t, 0, 0), Vector3::UnitX(),
                                 Vector3::UnitY());
        return palm;
      },
      [&](const Simulation& s) {
        for (const Contact& contact : s.result().contacts) {
          struck += contact.impulse;
          points += contact.impulse.isZero(0.0) ? 0 : 1;
        }
      });
  EXPECT_EQ(points, 2);
  EXPECT_NEAR(struck.norm() / 0.4, (1.0 + Material().restitution) * 0.5 * kSpeed, 1e-9);
}

// A heavy cube, which the difference of the forces hardly moves: thumb 35 mm deep in it, index 7 mm.
TEST(HandStrength, a_grasp_is_balanced_by_forces_and_not_by_depths) {
  Configuration configuration = testing::implicit_configuration();
  configuration.contact.hand = HandStrength::of_a_person();
  configuration.contact.grasp_assist = false;
  Simulation simulation(testing::scene_of(testing::stiff_box(Vector3::Constant(0.05), 100.0)), configuration);
  bool grasped = false;
  testing::play(
      simulation, 0.0, 0.5, 120.0,
      [](double t) {
        const double closed = testing::smooth(t, 0.2);
        Hand hand = testing::empty_hand();
        testing::add_fingertip(hand, capsule_index(1, 3), Vector3(0.035 - 0.017 * closed, 0, 0),
                               Vector3::UnitX());
        testing::add_fingertip(hand, capsule_index(0, 3), Vector3(-0.035 + 0.045 * closed, 0, 0),
                               -Vector3::UnitX());
        return hand;
      },
      [&](const Simulation& s) { grasped = grasped || testing::has_event(s, EventKind::grasp_begin); });
  EXPECT_TRUE(grasped);
}

}  // namespace
}  // namespace mrhi
