#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "mr_hand_interaction/parameters.h"
#include "support/printed_paper.h"

namespace mrhi {
namespace {

using testing::DraggedCube;
using testing::kPrintedGain;

constexpr double kHalf = DraggedCube::kHalf, kFingerRadius = DraggedCube::kRadius,
                 kCubeMass = DraggedCube::kMass, kContactStiffness = DraggedCube::kStiffness;
constexpr double kPressedBy = 0.002, kRate = 1000.0;  // of the centroids, a step a frame

Configuration literal(bool on) {
  Configuration configuration = testing::unfiltered(ContactModelKind::seed);
  configuration.contact.damping = configuration.contact.release_fade = false;
  set_parameter(configuration, "seed/literal", on ? "true" : "false");
  return configuration;
}

/// The cube's motion by Eqs. 16 to 20 as they are printed, with the opposite of f on the object, from a state
/// in which the god objects are `god` from the cube's middle along x.
struct Printed {
  double x, z, vx, vz;
  std::array<double, 2> god;

  void step(const Hand& hand, double h) {
    const Material material;
    double fx = 0.0, fz = 0.0;
    for (const int finger : {0, 1}) {
      const double side = finger == 1 ? 1.0 : -1.0;
      const Capsule& bone = hand.capsules[static_cast<std::size_t>(capsule_index(finger, 3))];
      const Vector3 p = 0.5 * (bone.start + bone.end);
      const double normal = kContactStiffness * (z + side * kHalf - p.z()) * side;
      double along = kContactStiffness * (x + god[static_cast<std::size_t>(finger)] - p.x());
      if (normal <= 0.0) continue;
      if (std::abs(along) > material.static_friction * normal) along *= material.dynamic_friction;
      fx -= along, fz -= side * normal;
    }
    vx += h * fx / kCubeMass, vz += h * fz / kCubeMass;
    x += h * vx, z += h * vz;
  }
};

TEST(SeedLiteral, computes_the_penetration_phase_as_printed) {
  Simulation simulation(testing::scene_of(DraggedCube::body()), literal(true));
  const auto hand_at = [](double t) { return DraggedCube::hand(t, kPressedBy, kPrintedGain); };
  testing::play(simulation, 0.0, 0.55, kRate, hand_at);
  const BodyState start = simulation.state().bodies[0];
  Printed printed{start.pose.position.x(),
                  start.pose.position.z(),
                  start.linear_momentum.x() / kCubeMass,
                  start.linear_momentum.z() / kCubeMass,
                  {}};
  ASSERT_EQ(simulation.result().contacts.size(), 2u);
  for (const Contact& contact : simulation.result().contacts)
    printed.god[contact.key.capsule == capsule_index(1, 3) ? 1 : 0] = contact.god_object.x();
  double slid = 0.0;
  Hand before = simulation.result().tracked.at(0);
  testing::play(simulation, 0.551, 1.2, kRate, hand_at, [&](const Simulation& s) {
    printed.step(before, 1.0 / kRate);
    before = s.result().tracked.at(0);
    slid = std::max(slid,
                    before.capsules[capsule_index(1, 3)].start.x() - s.state().bodies[0].pose.position.x());
  });
  const Vector3& place = simulation.state().bodies[0].pose.position;
  EXPECT_NEAR(place.x(), printed.x, 1e-9);
  EXPECT_NEAR(place.z(), printed.z, 1e-9);
  EXPECT_GT(slid, 2.0 * Material().static_friction * kPressedBy) << "it has left the cone";
}

// phi f_t grows with the stretch: what slides is drawn harder the farther it has slid, and goes farther. Both
// press as deep: ours with the skin, the printed one with the centroid.
TEST(SeedLiteral, what_slides_is_drawn_farther_than_coulombs_law_would) {
  std::array<double, 2> moved{};
  for (const bool on : {true, false}) {
    Simulation simulation(testing::scene_of(DraggedCube::body()), literal(on));
    const double depth = on ? kPressedBy : kPressedBy - kFingerRadius, gain = on ? kPrintedGain : 1.0;
    testing::play(simulation, 0.0, 0.75, kRate, [&](double t) { return DraggedCube::hand(t, depth, gain); });
    moved[on ? 0 : 1] = simulation.state().bodies[0].pose.position.x();
    RecordProperty(on ? "as_printed_mm" : "as_read_mm", std::to_string(1e3 * moved[on ? 0 : 1]));
  }
  EXPECT_GT(moved[0], 1.2 * moved[1]);
}

// Eq. 1 adds F + 1 samples and divides by F, under whatever filter is set.
TEST(SeedLiteral, puts_the_hand_by_eq_1_as_printed) {
  for (const bool on : {true, false}) {
    Configuration configuration = literal(on);
    configuration.filter.window = 3;
    Simulation simulation(testing::scene_of(DraggedCube::body()), configuration);
    testing::play(simulation, 0.0, 0.1, kRate, [](double) {
      return testing::finger(Vector3(0.3, 0.0, 0.2), Vector3(0.3, 0.02, 0.2), kFingerRadius);
    });
    const Vector3 expected = (on ? 4.0 / 3.0 : 1.0) * Vector3(0.3, 0.0, 0.2);
    EXPECT_LT((simulation.result().tracked.at(0).capsules[capsule_index(1, 3)].start - expected).norm(),
              1e-12);
  }
}

// Eqs. 9 to 15: j = (1 + e) m v with K = 1/m, and no spin, wherever it strikes.
TEST(SeedLiteral, strikes_without_a_spin) {
  Configuration configuration = literal(true);
  Body body = testing::box_body(Vector3::Constant(2.0 * kHalf), kCubeMass);
  body.material.restitution = 0.5;
  body.material.stiffness = kContactStiffness;
  Simulation simulation(testing::scene_of(body), configuration);
  constexpr double kSpeed = 0.5;
  testing::play(simulation, 0.0, 0.12, kRate, [](double t) {
    const double x = (-kHalf - kFingerRadius - kSpeed * (0.1 - t)) / kPrintedGain;
    return testing::finger({x, 0.015 / kPrintedGain, 0.005}, {x, 0.015 / kPrintedGain, -0.005},
                           kFingerRadius);
  });
  EXPECT_NEAR(testing::object_twist(simulation).linear.x(), 1.5 * kSpeed, 1e-9);
  EXPECT_EQ(testing::object_twist(simulation).angular, Vector3(0, 0, 0));
}

}  // namespace
}  // namespace mrhi
