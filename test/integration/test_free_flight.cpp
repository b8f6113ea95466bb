#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "integration/free_flight.h"
#include "scene/solid_mesh.h"
#include "support/fixtures.h"

namespace mrhi {
namespace {

Body asymmetric_body() {
  Body body;
  body.name = "asymmetric";
  body.mass = 0.1;
  body.inertia = Vector3(1e-4, 2e-4, 3e-4).asDiagonal();
  complete(body);
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

// Scene (b): 60 s about the intermediate axis at 1 ms. Momentum is the state, so it may not change at all.
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
  EXPECT_LE(std::abs(kinetic_energy(body, state) / energy - 1.0), 1e-13);  // rounding of 60 000 steps
  ASSERT_GE(times.size(), 30u);
  EXPECT_NEAR((times.back() - times.front()) / static_cast<double>(times.size() - 1), 1.9553, 1e-4);
}

Body body_of(const Vector3& moments, const Vector3& spin, const Quaternion& turned = Quaternion::Identity()) {
  Body body = asymmetric_body();
  const Matrix3 axes = turned.toRotationMatrix();
  body.inertia = axes * moments.asDiagonal() * axes.transpose();
  complete(body);
  body.start_twist.angular = axes * spin;
  return body;
}

/// Tops, tumbling and symmetric bodies, near the separatrix and on it; moments in 1e-4 kg m^2, spins in
/// rad/s.
std::vector<Body> bodies_that_turn() {
  const Quaternion aslant(Eigen::AngleAxisd(0.7, Vector3(1, 2, 3).normalized()));
  std::vector<Body> bodies;
  for (const Vector3& moments :
       {Vector3(1, 2, 3), Vector3(1, 1, 2), Vector3(1, 1, 1), Vector3(2, 1, 3), Vector3(1, 2, 2.001),
        Vector3(0.05, 1, 1), Vector3(1e-3, 1, 1), Vector3(1, 0.01, 1.01)}) {
    for (const Vector3& spin :
         {Vector3(0.1, 10, 0.1), Vector3(3, 4, 5), Vector3(10, 1e-3, 1e-3), Vector3(1e-6, 10, 1e-6),
          Vector3(0, 0, 10), Vector3(0, 10, 0), Vector3(100, 60, 20)})
      bodies.push_back(
          body_of(1e-4 * moments, spin, bodies.size() % 2 == 0 ? Quaternion::Identity() : aslant));
  }
  return bodies;
}

Quaternion turned_in_a_second(const Body& body, int steps) {
  BodyState state = start_state(body);
  for (int i = 0; i < steps; ++i) free_flight(body, Vector3::Zero(), 1.0 / steps, state);
  return state.pose.orientation;
}

/// Longest step in which neither the momentum in the body turns by more than 0.025 rad, nor the body by 0.25
/// about it. Of Euler's equations with j = (J3 - J2, J1 - J3, J2 - J1), J2 between the others, j1^2 m3^2 +
/// j3^2 m1^2 + j1 j3 (|m|^2 + m2^2) and the energy are integrals.
double longest_undivided(const Body& body) {
  const BodyState state = start_state(body);
  const Vector3 m =
      body.principal_axes.transpose() * (state.pose.orientation.conjugate() * state.angular_momentum);
  const Vector3& moments = body.inverse_moments;
  const double j1 = moments.z() - moments.y(), j3 = moments.y() - moments.x();
  const double rate = std::sqrt(j1 * j1 * m.z() * m.z() + j3 * j3 * m.x() * m.x() +
                                j1 * j3 * (m.squaredNorm() + m.y() * m.y()));
  return 1.0 / std::max(rate / 0.025, 2.0 * kinetic_energy(body, state) / m.norm() / 0.25);
}

/// The spin about a slender body's length is what its momentum has along it, over the least moment: rounding
/// of the orientation shows there so many times larger.
bool is_slender(const Body& body) {
  return body.inverse_moments.maxCoeff() > 50.0 * body.inverse_moments.minCoeff();
}

// Rounding of the steps: an error of 1e-16 in each, which on the separatrix grows e-fold in 0.17 s, and in
// 0.1 s for the slender one.
TEST(FreeFlight, orientation_does_not_depend_on_the_step) {
  for (const Body& body : bodies_that_turn()) {
    const Quaternion fine = turned_in_a_second(body, 2000);
    for (const int steps : {1, 7, 50, 120, 1000}) {
      if (1.0 > 5000 * steps * longest_undivided(body)) continue;  // more parts than a step may have
      EXPECT_LE(fine.angularDistance(turned_in_a_second(body, steps)), is_slender(body) ? 3e-10 : 2e-11)
          << body.inertia << '\n'
          << body.start_twist.angular.transpose() << ", " << steps << " steps";
    }
  }
}

/// Runge and Kutta's method on the quaternion itself, in steps so small that what it leaves is 1e-11.
Quaternion turned_by_small_steps(const Body& body) {
  constexpr int kSteps = 20000;
  const Vector3 momentum = start_state(body).angular_momentum;
  const auto rate = [&](const Quaternion& q) -> Eigen::Vector4d {
    const Vector3 spin = body.inverse_inertia * (q.conjugate() * momentum);
    return 0.5 / kSteps * (q * Quaternion(0.0, spin.x(), spin.y(), spin.z())).coeffs();
  };
  Quaternion q = body.start.orientation;
  for (int i = 0; i < kSteps; ++i) {
    const Eigen::Vector4d k1 = rate(q), k2 = rate(Quaternion(Eigen::Vector4d(q.coeffs() + 0.5 * k1))),
                          k3 = rate(Quaternion(Eigen::Vector4d(q.coeffs() + 0.5 * k2))),
                          k4 = rate(Quaternion(Eigen::Vector4d(q.coeffs() + k3)));
    q.coeffs() += (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
    q.normalize();
  }
  return q;
}

TEST(FreeFlight, orientation_is_that_of_eulers_equations) {
  for (const Body& body : bodies_that_turn()) {
    if (body.start_twist.angular.norm() > 20.0) continue;  // beyond the reference
    EXPECT_LE(turned_by_small_steps(body).angularDistance(turned_in_a_second(body, 50)), 1e-9)
        << body.inertia << '\n'
        << body.start_twist.angular.transpose();
  }
}

// A day at one step per 20 ms frame, 4.3 million steps: were each rounded by 1e-16 one way, 4e-10.
TEST(FreeFlight, energy_holds_for_a_day_at_one_step_a_frame) {
  for (const Vector3& spin : {Vector3(0.1, 10, 0.1), Vector3(3, 4, 5), Vector3(0.01, 0.02, 0.03),
                              Vector3(0.2, 0.3, 0.4), Vector3(0, 0.1, 8)}) {
    const Body body = body_of(Vector3(1e-4, 2e-4, 3e-4), spin);
    BodyState state = start_state(body);
    const double energy = kinetic_energy(body, state);
    double most = 0.0;
    for (int i = 0; i < 24 * 3600 * 50; ++i) {
      free_flight(body, Vector3::Zero(), 0.02, state);
      if (i % 1000 == 0) most = std::max(most, std::abs(kinetic_energy(body, state) / energy - 1.0));
    }
    EXPECT_LE(most, 1e-12) << spin.transpose();
  }
}

// Rounding of the steps: 1e-16 each, of numbers of size 1. At 0.025 rad the terms that the series leave out
// would be 3e-18; were one term less taken, 1e-15 and more.
TEST(FreeFlight, the_longest_step_without_parts_is_exact) {
  for (const Body& body : bodies_that_turn()) {
    const double step = longest_undivided(body) * (1.0 - 1e-9);
    BodyState whole = start_state(body), halves = whole;
    free_flight(body, Vector3::Zero(), step, whole);
    for (int i = 0; i < 2; ++i) free_flight(body, Vector3::Zero(), 0.5 * step, halves);
    EXPECT_LE((halves.pose.orientation.coeffs() - whole.pose.orientation.coeffs()).norm(),
              is_slender(body) ? 1e-15 : 4e-16)
        << body.inertia << '\n'
        << body.start_twist.angular.transpose();
  }
}

// 1e9 rad/s: what no picture shows takes a bounded time, and keeps momentum and a unit orientation.
TEST(FreeFlight, an_absurd_spin_stays_finite) {
  Body body = asymmetric_body();
  body.start_twist.angular = Vector3(1e9, 2e9, 3e9);
  BodyState state = start_state(body);
  const Vector3 momentum = state.angular_momentum;
  free_flight(body, Vector3::Zero(), 0.02, state);
  EXPECT_EQ(state.angular_momentum, momentum);
  EXPECT_NEAR(state.pose.orientation.norm(), 1.0, 1e-14);
}

TEST(FreeFlight, next_to_no_spin_is_none) {
  const Body body = asymmetric_body();
  for (const double size : {0.0, 1e-310, 1e-170, 1e-101, 1e-99}) {
    BodyState state;
    state.angular_momentum = Vector3(size, 0.0, size);
    free_flight(body, Vector3::Zero(), 0.01, state);
    EXPECT_LE((state.pose.orientation.coeffs() - Quaternion::Identity().coeffs()).norm(), 1e-90) << size;
  }
}

// Ten seconds of short turns, in small and in large steps; 1e-11 is the rounding of 10000 steps.
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
  complete(body);
  body.start_twist.angular = Vector3(0.0, 0.0, 200.0);  // 3.3 rad a step: several turns in each
  BodyState state = start_state(body);
  for (int i = 0; i < 60; ++i) free_flight(body, Vector3::Zero(), 1.0 / 60.0, state);
  const Quaternion expected(Eigen::AngleAxisd(200.0, Vector3::UnitZ()));
  EXPECT_LE(state.pose.orientation.angularDistance(expected), 1e-12);
}

// A knitting needle that tumbles, with and without a spin about its length; one step a frame.
TEST(FreeFlight, a_slender_rod_turns_at_the_rate_that_it_reports) {
  for (const double along : {0.0, 1.0, 40.0}) {
    Body rod = testing::box_body(Vector3(0.001, 0.001, 0.3), 0.01);
    rod.shapes = {{Cylinder{0.0005, 0.15}, {}}};
    rod.inertia = inertia_of(rod.shapes, 0.01);
    complete(rod);
    rod.start_twist.angular = Vector3(5.0, 0.0, along);
    BodyState state = start_state(rod);
    double turned = 0.0;
    for (int i = 0; i < 120; ++i) {
      const Vector3 before = state.pose.orientation * Vector3::UnitZ();
      free_flight(rod, Vector3::Zero(), 1.0 / 60.0, state);
      turned += std::acos(std::min(1.0, before.dot(state.pose.orientation * Vector3::UnitZ())));
    }
    EXPECT_NEAR(turned, 10.0, 1e-3) << along;  // a cone narrower by 1e-5 * 40 / 5 than a great circle
  }
}

TEST(FreeFlight, a_fixture_stays) {
  Body body = asymmetric_body();
  body.fixed = true;
  complete(body);
  BodyState state = start_state(body);
  free_flight(body, Vector3(0, 0, -9.81), 1.0, state);
  EXPECT_EQ(state.pose.position, Vector3::Zero());
}

}  // namespace
}  // namespace mrhi
