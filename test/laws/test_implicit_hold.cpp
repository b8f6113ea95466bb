#include <gtest/gtest.h>

#include "support/pinch_ride.h"

namespace mrhi {
namespace {

using testing::eased;
using testing::PinchScene;
using testing::Ride;

constexpr double kDegree = M_PI / 180.0;

Ride ride(const PinchScene& pinch, double step, double rate, const std::function<Vector3(double)>& sway) {
  Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
  configuration.step = step;
  return testing::ride(pinch, configuration, rate, sway);
}

/// How far the springs at rest give way to the cube's inertia. It is m a / sum k where their centre is the
/// cube's; here four fingers face one thumb, so that the cube turns a little as well and its centre moves by
/// more.
double springs_own(const PinchScene& pinch, double amplitude, double frequency) {
  Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
  Simulation simulation(pinch.scene(), configuration);
  testing::play(simulation, 0.0, testing::kRideFrom, 1000.0,
                [&](double t) { return pinch.hand(t, Vector3::Zero()); });
  Eigen::Matrix<double, 6, 6> stiffness = Eigen::Matrix<double, 6, 6>::Zero();
  double sum = 0.0;
  for (const Contact& contact : simulation.state().contacts) {
    if (!contact.touching()) continue;
    Eigen::Matrix<double, 3, 6> jacobian;
    jacobian << Matrix3::Identity(),
        -cross_matrix(contact.point - simulation.state().bodies[0].pose.position);
    stiffness += pinch.stiffness * contact.share * jacobian.transpose() * jacobian;
    sum += pinch.stiffness * contact.share;
  }
  EXPECT_NEAR(sum, 5.0 * pinch.stiffness, 1e-6);
  Eigen::Matrix<double, 6, 1> load = Eigen::Matrix<double, 6, 1>::Zero();
  load.head<3>() = pinch.mass * amplitude * std::pow(2.0 * M_PI * frequency, 2) * Vector3(1, 2, 2) / 3.0;
  return stiffness.ldlt().solve(load).head<3>().norm();
}

TEST(ImplicitPinch, after_the_swing_the_cube_sits_where_it_sat_before) {
  const PinchScene pinch;
  const Ride swung = ride(pinch, 0.001, 1000.0, eased(0.1, 0.5));
  EXPECT_LE(swung.true_slip, 1e-6);
  EXPECT_LE(swung.true_turn, 1e-3 * kDegree);
  EXPECT_LE(swung.jitter, 1e-8);
}

TEST(ImplicitPinch, after_the_shake_the_cube_sits_where_it_sat_before) {
  const PinchScene pinch;
  const Ride shaken = ride(pinch, 0.001, 1000.0, eased(0.05, 3.0));
  EXPECT_LE(shaken.true_slip, 1e-6);
  EXPECT_LE(shaken.true_turn, 1e-3 * kDegree);
  EXPECT_LE(shaken.jitter, 1e-8);
}

TEST(ImplicitPinch, is_still_held_at_one_step_per_frame) {
  const PinchScene pinch;
  EXPECT_LE(ride(pinch, 1.0 / 119.0, 120.0, eased(0.1, 0.5)).true_slip, 1e-5);
  EXPECT_LE(ride(pinch, 1.0 / 119.0, 120.0, eased(0.05, 3.0)).true_slip, 1e-5);
}

/// The phalanx next to the thumb's tip is 0.8 mm from the cube, which the hand's change of speed over a step
/// of this length exceeds: the springs carry the cube along before it could strike.
TEST(ImplicitPinch, is_not_struck_by_phalanges_beside_the_grip_in_long_steps) {
  const PinchScene pinch;
  EXPECT_LE(ride(pinch, 1.0 / 59.0, 60.0, eased(0.05, 3.0)).true_slip, 1e-5);
}

/// Springs of 2e6 N/m give by 1e-8 m. What Newton's method may leave is a part of what they push with, and in
/// a step as long as this was once a way of 3.5 um.
TEST(ImplicitPinch, hard_contacts_hold_as_still_in_long_steps) {
  PinchScene pinch;
  pinch.stiffness = 2e6;
  EXPECT_LE(ride(pinch, 1.0 / 59.0, 60.0, eased(0.1, 0.5)).displacement, 1e-7);
}

TEST(ImplicitPinch, grip_force_is_stiffness_times_overlap_at_rest) {
  const PinchScene pinch;
  const Ride still = ride(pinch, 0.001, 1000.0, [](double) -> Vector3 { return Vector3::Zero(); });
  EXPECT_NEAR(still.push / (pinch.stiffness * still.overlap), 1.0, 1e-3);
  EXPECT_GT(still.push, 10.0);
}

TEST(ImplicitPinch, while_it_swings_the_displacement_is_the_springs_own) {
  const PinchScene pinch;
  const Ride swung = ride(pinch, 0.001, 1000.0, eased(0.05, 3.0));
  const double expected = springs_own(pinch, 0.05, 3.0);
  EXPECT_NEAR(swung.displacement / expected, 1.0, 0.1);
}

}  // namespace
}  // namespace mrhi
