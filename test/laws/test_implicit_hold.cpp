#include <gtest/gtest.h>

#include "support/pinch_scene.h"

namespace mrhi {
namespace {

using testing::at;
using testing::object_twist;
using testing::PinchScene;
using testing::smooth;
using testing::swing;

constexpr double kSettled = 1.0;  // [s]
constexpr double kMoving = 10.0;  // [s]
constexpr double kDegree = M_PI / 180.0;

/// Where the cube sits in the hand.
struct Seat {
  Vector3 position;
  Quaternion orientation;
};

struct Ride {
  double true_slip = 0.0;     // after the motion against before [m]
  double true_turn = 0.0;     // [rad]
  double displacement = 0.0;  // largest while moving [m]
  double jitter = 0.0;        // rms of the cube's speed while the hand is still again, times a step [m]
  double push = 0.0;          // sum of the normal forces at rest [N]
  double overlap = 0.0;       // sum of depths times shares at rest [m]
};

Ride ride(const PinchScene& pinch, double step, double rate, const std::function<Vector3(double)>& sway) {
  Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
  configuration.step = step;
  Simulation simulation(pinch.scene(), configuration);
  const auto sway_at = [&](double t) -> Vector3 {
    return t < kSettled || t >= kSettled + kMoving ? Vector3::Zero() : sway(t - kSettled);
  };
  const auto seat = [&](double t) {
    const BodyState& state = simulation.state().bodies[0];
    return Seat{state.pose.position - sway_at(t), state.pose.orientation};
  };
  const auto advance = [&](double t) { simulation.advance({at(t), {pinch.hand(t, sway_at(t))}}); };
  int frame = 0;
  for (; frame / rate < kSettled; ++frame) advance(frame / rate);
  const Seat before = seat(0.0);
  Ride result;
  for (const Contact& contact : simulation.state().contacts) {
    result.push -= contact.normal.dot(contact.force);
    if (contact.touching()) result.overlap += contact.share * contact.depth;
  }
  for (; frame / rate < kSettled + kMoving; ++frame) {
    advance(frame / rate);
    result.displacement =
        std::max(result.displacement, (seat(frame / rate).position - before.position).norm());
  }
  for (; frame / rate < kSettled + kMoving + 2.0; ++frame) advance(frame / rate);
  const Seat after = seat(0.0);
  result.true_slip = (after.position - before.position).norm();
  result.true_turn = after.orientation.angularDistance(before.orientation);
  result.jitter = object_twist(simulation).linear.norm() * step;
  return result;
}

/// Ends softly, so that the motion has no blow in it that scene (a) does not have.
std::function<Vector3(double)> eased(double amplitude, double frequency) {
  return [=](double t) -> Vector3 {
    return smooth(t, 1.0) * (1.0 - smooth(t - kMoving + 1.0, 1.0)) * swing(t, amplitude, frequency);
  };
}

/// How far the springs at rest give way to the cube's inertia. It is m a / sum k where their centre is the
/// cube's; here four fingers face one thumb, so that the cube turns a little as well and its centre moves by
/// more.
double springs_own(const PinchScene& pinch, double amplitude, double frequency) {
  Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
  Simulation simulation(pinch.scene(), configuration);
  testing::play(simulation, 0.0, kSettled, 1000.0, [&](double t) { return pinch.hand(t, Vector3::Zero()); });
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
