#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "mr_hand_interaction/integration/free_flight.h"

namespace mrhi {
namespace {

Body asymmetric_body() {
  Body body;
  body.name = "asymmetric";
  body.mass = 0.1;
  body.inertia = Vector3(1e-4, 2e-4, 3e-4).asDiagonal();
  body.inverse_inertia = body.inertia.inverse();
  body.start_twist.angular = Vector3(0.1, 10.0, 0.1);
  return body;
}

/// Times at which the spin about the body's intermediate axis changes sign.
std::vector<double> flips(const Body& body, BodyState& state, double step, int steps) {
  std::vector<double> times;
  double last = 1.0;
  for (int i = 1; i <= steps; ++i) {
    free_flight(body, Vector3::Zero(), step, state);
    const double spin = (state.pose.orientation.conjugate() * state.angular_momentum).y();
    if (spin * last < 0.0) times.push_back(i * step);
    if (spin != 0.0) last = spin;
  }
  return times;
}

// Scene (b): 60 s about the intermediate axis at 1 ms. Momentum is the state, so it may not change at all;
// the energy's tolerance is the fourth-order method's.
TEST(FreeFlight, intermediate_axis_flip_keeps_momentum_energy_and_period) {
  const Body body = asymmetric_body();
  BodyState state = start_state(body);
  const Vector3 momentum = state.angular_momentum;
  const double energy = kinetic_energy(body, state);

  const std::vector<double> times = flips(body, state, 0.001, 60000);

  EXPECT_LE((state.angular_momentum - momentum).norm() / momentum.norm(), 1e-13);
  const Vector3 from_velocity =
      world_inverse_inertia(body, state.pose.orientation).inverse() * twist_of(body, state).angular;
  EXPECT_LE((from_velocity - momentum).norm() / momentum.norm(), 1e-13);
  EXPECT_LE(std::abs(kinetic_energy(body, state) / energy - 1.0), 1e-9);
  ASSERT_GE(times.size(), 30u);
  EXPECT_NEAR((times.back() - times.front()) / static_cast<double>(times.size() - 1), 1.9553, 1e-4);
}

TEST(FreeFlight, halving_the_step_divides_the_orientation_error_by_sixteen) {
  const Body body = asymmetric_body();
  const auto orientation_after_a_second = [&](int steps) {
    BodyState state = start_state(body);
    for (int i = 0; i < steps; ++i) free_flight(body, Vector3::Zero(), 1.0 / steps, state);
    return state.pose.orientation;
  };
  const Quaternion reference = orientation_after_a_second(20000);
  const double coarse = reference.angularDistance(orientation_after_a_second(100));
  const double fine = reference.angularDistance(orientation_after_a_second(200));
  EXPECT_GT(coarse, 1e-9);
  EXPECT_NEAR(coarse / fine, 16.0,
              3.0);  // order four; higher orders of the coarse step move the ratio a little
}

// Ten seconds of turns just below and well above the one from which on the full method is used; 1e-11 is the
// rounding of 10000 steps.
TEST(FreeFlight, a_slow_turn_does_not_depend_on_the_step) {
  Body body = asymmetric_body();
  body.start_twist.angular = Vector3(5e-3, 5e-3, 5e-3);
  const auto after_ten_seconds = [&](int steps) {
    BodyState state = start_state(body);
    for (int i = 0; i < steps; ++i) free_flight(body, Vector3::Zero(), 10.0 / steps, state);
    return state.pose.orientation;
  };
  EXPECT_LE(after_ten_seconds(10000).angularDistance(after_ten_seconds(100)), 1e-11);
}

TEST(FreeFlight, momentum_does_not_change_by_a_bit_at_any_step) {
  const Body body = asymmetric_body();
  for (const double step : {0.00025, 0.001, 0.0167, 0.5}) {
    BodyState state = start_state(body);
    state.linear_momentum = Vector3(0.01, -0.02, 0.03);
    const BodyState before = state;
    for (int i = 0; i < 1000; ++i) free_flight(body, Vector3::Zero(), step, state);
    EXPECT_EQ(state.angular_momentum, before.angular_momentum) << step;
    EXPECT_EQ(state.linear_momentum, before.linear_momentum) << step;
    EXPECT_NEAR(state.pose.orientation.norm(), 1.0, 1e-15);
  }
}

TEST(FreeFlight, falls_along_the_exact_parabola_at_any_step) {
  Body body = asymmetric_body();
  body.start_twist.linear = Vector3(1.0, 0.0, 2.0);
  const Vector3 gravity(0.0, 0.0, -9.81);
  for (const int steps : {1, 7, 1000}) {
    BodyState state = start_state(body);
    for (int i = 0; i < steps; ++i) free_flight(body, gravity, 1.0 / steps, state);
    EXPECT_NEAR(state.pose.position.z(), 2.0 - 0.5 * 9.81, 1e-12) << steps;  // rounding of 1000 sums
    EXPECT_NEAR(state.pose.position.x(), 1.0, 1e-12) << steps;
  }
}

TEST(FreeFlight, a_symmetric_body_turns_at_its_constant_rate) {
  Body body = asymmetric_body();
  body.inertia = 2e-4 * Matrix3::Identity();
  body.inverse_inertia = body.inertia.inverse();
  body.start_twist.angular = Vector3(0.0, 0.0, 200.0);  // 3.3 rad a step: several turns in each
  BodyState state = start_state(body);
  for (int i = 0; i < 60; ++i) free_flight(body, Vector3::Zero(), 1.0 / 60.0, state);
  const Quaternion expected(Eigen::AngleAxisd(200.0, Vector3::UnitZ()));
  EXPECT_LE(state.pose.orientation.angularDistance(expected), 1e-7);
}

TEST(FreeFlight, a_fixture_stays) {
  Body body = asymmetric_body();
  body.fixed = true;
  BodyState state = start_state(body);
  free_flight(body, Vector3(0, 0, -9.81), 1.0, state);
  EXPECT_EQ(state.pose.position, Vector3::Zero());
}

}  // namespace
}  // namespace mrhi
