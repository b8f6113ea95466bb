#include <gtest/gtest.h>

#include "support/grips.h"
#include "support/one_side_leaves.h"

namespace mrhi {
namespace {

using testing::at;
using testing::kDegrees;
using testing::PinchScene;
using testing::smooth;

constexpr double kHalfWidth = 0.025;
constexpr double kPressedBy = 0.002;  // [m] on each side
constexpr double kOpens = 1.5;        // [s]
constexpr double kOpening = 0.3;      // speed of each fingertip [m/s]

/// A pinch that is carried at `velocity` from 0.8 s on (reached softly within half a second) and opens at
/// kOpens. Returns the cube's twist when nothing touches it any more.
Twist released(const Vector3& velocity, double rate, double step) {
  Configuration configuration = testing::implicit_configuration();
  configuration.step = step;
  Simulation simulation(testing::scene_of(testing::stiff_box(Vector3::Constant(2.0 * kHalfWidth), 0.1)),
                        configuration);
  Vector3 way = Vector3::Zero();
  double last = 0.0;
  testing::play(simulation, 0.0, kOpens + 0.1, rate, [&](double t) {
    way += smooth(0.5 * (t + last) - 0.8, 0.5) * (t - last) * velocity;
    last = t;
    const double gap = testing::closing_gap(t, kPressedBy) + kOpening * std::max(0.0, t - kOpens);
    Pose carried;
    carried.position = way;
    return testing::moved(testing::symmetric_pinch(kHalfWidth, gap), carried);
  });
  EXPECT_TRUE(simulation.result().contacts.empty());
  return testing::object_twist(simulation);
}

struct Input {
  double rate, step;
};
constexpr Input kInputs[] = {{1000.0, 0.001}, {120.0, 0.001}, {120.0, 1.0 / 119.0}, {60.0, 1.0 / 59.0}};

// The thumb's 2000 N/m, pressed by 8 mm, would push 0.1 kg to 1.1 m/s; damping takes a part of it. With the
// fade it is the release speed, 0.1 m/s, and the end of the step in which that is reached; help does not take
// the cube along with the fingers that leave either.
TEST(ImplicitRelease, a_finger_that_stays_does_not_shoot_the_cube_away) {
  Configuration configuration = testing::implicit_configuration();
  EXPECT_LE(testing::speed_as_one_side_leaves(configuration), 0.11);
  configuration.contact.release_fade = false;
  EXPECT_GE(testing::speed_as_one_side_leaves(configuration), 0.3);
}

TEST(ImplicitRelease, a_symmetric_pinch_that_opens_leaves_the_cube_where_it_is) {
  for (const Input& input : kInputs) {
    const Twist twist = released(Vector3::Zero(), input.rate, input.step);
    EXPECT_LE(twist.linear.norm(), 0.005) << input.rate << " " << input.step;
    EXPECT_LE(twist.angular.norm() * kHalfWidth, 0.005) << input.rate << " " << input.step;
  }
}

TEST(ImplicitRelease, a_moving_hand_lets_go_of_the_cube_at_the_velocity_it_had) {
  for (const Vector3& velocity : {Vector3(0.0, 0.2, 0.3), Vector3(0.2, 0.1, 0.0), Vector3(0.5, 0.0, 0.0)}) {
    for (const Input& input : kInputs) {
      const Twist twist = released(velocity, input.rate, input.step);
      EXPECT_LE((twist.linear - velocity).norm(), 0.02 * velocity.norm())
          << velocity.transpose() << " at " << input.rate << " " << input.step;
    }
  }
}

TEST(ImplicitRelease, a_slow_drift_stays_what_it_was) {
  for (const Vector3& velocity : {Vector3(0.0, 0.0, 0.01), Vector3(0.01, 0.0, 0.0)}) {
    for (const Input& input : kInputs) {
      const Twist twist = released(velocity, input.rate, input.step);
      EXPECT_LE((twist.linear - velocity).norm(), 0.02 * 0.01)
          << velocity.transpose() << " at " << input.rate << " " << input.step;
    }
  }
}

}  // namespace
}  // namespace mrhi
