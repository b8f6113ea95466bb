#include <gtest/gtest.h>

#include "response/penetration_model.h"
#include "support/fixtures.h"
#include "support/one_side_leaves.h"

namespace mrhi {
namespace {

using testing::box_body;
using testing::finger;
using testing::object_twist;
using testing::play;
using testing::scene_of;
using testing::unfiltered;

constexpr double kStiffness = 2000.0;
constexpr double kRadius = 0.008;

TEST(Coulomb, inside_the_cone_the_spring_force_stands) {
  const Material material;
  const Vector3 pull(0.7, 0.0, 0.0);
  const Tangential result = coulomb(pull, 1.0, material, Friction::sticking);
  EXPECT_EQ(result.force, pull);
  EXPECT_EQ(result.friction, Friction::sticking);
}

TEST(Coulomb, outside_the_cone_the_force_is_dynamic_friction_times_normal_force) {
  const Material material;
  for (const double pull : {0.81, 2.0, 100.0}) {
    const Tangential result = coulomb(Vector3(0.0, pull, 0.0), 1.0, material, Friction::sticking);
    EXPECT_EQ(result.friction, Friction::slipping);
    EXPECT_NEAR(result.force.norm(), material.dynamic_friction, 1e-12) << pull;
    EXPECT_GT(result.force.y(), 0.0);
  }
}

TEST(Coulomb, what_slips_sticks_again_well_below_the_dynamic_cone) {
  const Material material;  // mu 0.8, phi 0.6
  EXPECT_EQ(coulomb(Vector3(0.59, 0, 0), 1.0, material, Friction::slipping).friction, Friction::slipping);
  EXPECT_EQ(coulomb(Vector3(0.50, 0, 0), 1.0, material, Friction::slipping).friction, Friction::sticking);
  EXPECT_EQ(coulomb(Vector3(0.79, 0, 0), 1.0, material, Friction::sticking).friction, Friction::sticking);
}

TEST(NormalForce, is_stiffness_times_depth_at_rest_and_never_pulls) {
  EXPECT_DOUBLE_EQ(normal_force(100.0, 0.004, 0.0, 10.0), 0.4);
  EXPECT_DOUBLE_EQ(normal_force(100.0, 0.004, -1.0, 10.0), 0.4);
  EXPECT_EQ(normal_force(100.0, 0.004, 10.0, 10.0), 0.0);
  EXPECT_EQ(normal_force(100.0, -0.004, 0.0, 10.0), 0.0);
  EXPECT_EQ(normal_force(100.0, 0.0, 0.0, 10.0), 0.0);
}

// The paper's spring gives back all that it has taken (Eq. 17).
TEST(NormalForce, fades_as_the_surfaces_part_or_keeps_to_the_paper) {
  EXPECT_DOUBLE_EQ(normal_force(100.0, 0.004, 0.05, 10.0), 0.2);
  EXPECT_DOUBLE_EQ(normal_force(100.0, 0.004, 0.05, 0.0), 0.4);
  EXPECT_DOUBLE_EQ(normal_force(100.0, 0.004, 10.0, 0.0), 0.4);
}

// Four fingers against the thumb, each drawn 5 mm deep: the thumb's spring has 4/5 of the 10 mm between them.
// At 1 ms a step the explicit spring is right to 5 %, and the fingers take a while to be gone.
TEST(Seed, gives_back_what_a_spring_has_taken_where_it_keeps_to_the_letter) {
  Configuration configuration = unfiltered(ContactModelKind::seed);
  configuration.stiffness = 2000.0;
  const double all = 0.8 * 0.01 * std::sqrt(2000.0 / testing::PinchScene().mass);
  EXPECT_LE(testing::speed_as_one_side_leaves(configuration), 0.15);  // 0.1 and half a step of the push
  configuration.contact.damping = configuration.contact.release_fade = false;
  EXPECT_NEAR(testing::speed_as_one_side_leaves(configuration), all, 0.1 * all);
}

/// A block that slides at `speed` between two still fingers that press it from both sides along z by
/// `overlap`.
double sliding_distance(double speed, double overlap, const Material& material) {
  Body body = box_body(Vector3(0.4, 0.1, 0.02), 0.2);
  body.material = material;
  body.start.position.x() = 0.15;
  body.start_twist.linear = Vector3(-speed, 0, 0);
  Simulation simulation(scene_of(body), unfiltered(ContactModelKind::penetration));
  const auto hand_at = [&](double t) {
    // Away at first, so that the hand does not appear inside the block.
    const double gap = t < 0.02 ? 0.01 : -overlap;
    const double z = 0.01 + kRadius + gap;
    Hand hand = finger(Vector3(0, -0.01, z), Vector3(0, 0.01, z), kRadius);
    testing::add_finger(hand, capsule_index(0, 3), Vector3(0, -0.01, -z), Vector3(0, 0.01, -z), kRadius);
    return hand;
  };
  play(simulation, 0.0, 0.03, 1000.0, hand_at);
  const double from = simulation.state().bodies[0].pose.position.x();
  const double v = object_twist(simulation).linear.x();
  play(simulation, 0.031, 1.5, 1000.0, hand_at);
  EXPECT_NEAR(object_twist(simulation).linear.norm(), 0.0, 1e-3);
  const double force = 2.0 * material.stiffness * overlap;
  const double expected = v * v / (2.0 * material.dynamic_friction * force / body.mass);
  return (from - simulation.state().bodies[0].pose.position.x()) / expected;
}

// v^2 / (2 phi g) with the grip in the place of gravity. The springs' own give (phi f / k, about 1 mm at each
// end of the way of 80 mm) is what the 2 % allow for.
TEST(Sliding, stops_after_v_squared_over_twice_the_deceleration) {
  Material material;
  material.stiffness = kStiffness;
  EXPECT_NEAR(sliding_distance(0.5, 0.0005, material), 1.0, 0.02);
  material.dynamic_friction = 0.3;
  material.static_friction = 0.35;
  EXPECT_NEAR(sliding_distance(0.4, 0.0005, material), 1.0, 0.02);
}

}  // namespace
}  // namespace mrhi
