#include <gtest/gtest.h>

#include "support/pinched_cube.h"

namespace mrhi {
namespace {

using testing::fixed_block;
using testing::lying;
using testing::PinchedCube;
using testing::total_force;

constexpr ContactModelKind kVirtualSpring = ContactModelKind::virtual_spring;
constexpr double kModelStiffness = 500.0;  // the model's own [N/m]
constexpr double kPhalanxMass = 0.01;      // of what the damper is critical for [kg]
const double kDamping = 2.0 * std::sqrt(kModelStiffness * kPhalanxMass);

TEST(VirtualSpring, force_at_rest_is_stiffness_times_overlap) {
  PinchedCube pinch(kVirtualSpring);
  pinch.hold(2.0);
  double push = 0.0;
  for (const Contact& contact : pinch.simulation().state().contacts) {
    const double normal = -contact.normal.dot(contact.force);
    EXPECT_NEAR(normal, kModelStiffness * contact.share * std::max(0.0, contact.depth), 1e-6);
    push += normal;
  }
  EXPECT_GT(push, 3.0);
}

TEST(VirtualSpring, force_of_a_moving_phalanx_is_that_of_spring_and_damper) {
  Simulation simulation = fixed_block(kVirtualSpring);
  const double speed = 0.02;
  testing::play(simulation, 0.0, 0.2, 1000.0, [&](double t) { return lying(0, 0.002 - speed * t); });
  // Step 200 begins where frame 199 left the finger.
  const double depth = speed * 0.199 - 0.002;
  EXPECT_NEAR(total_force(simulation).z(), -(kModelStiffness * depth + kDamping * speed), 1e-6);
}

TEST(VirtualSpring, momenta_change_by_the_forces_impulses) {
  PinchedCube pinch(kVirtualSpring);
  BodyState before = pinch.cube();
  pinch.play(
      2.0, [](double t) -> Vector3 { return testing::swing(t, 0.02, 3.0); },
      [&] {
        Vector3 impulse = Vector3::Zero(), turn = Vector3::Zero();
        for (const Contact& contact : pinch.simulation().state().contacts) {
          impulse += contact.force / PinchedCube::kRate;
          turn += (contact.point - before.pose.position).cross(contact.force) / PinchedCube::kRate;
        }
        const BodyState& after = pinch.cube();
        EXPECT_LE((after.linear_momentum - before.linear_momentum - impulse).norm(), 1e-14);
        EXPECT_LE((after.angular_momentum - before.angular_momentum - turn).norm(), 1e-15);
        before = after;
      });
}

}  // namespace
}  // namespace mrhi
