#include <gtest/gtest.h>

#include "support/grips.h"

namespace mrhi {
namespace {

using testing::at;
using testing::PinchScene;

constexpr double kGravity = 9.81;      // [m/s^2]
constexpr double kRate = 60.0;         // frames [1/s]
constexpr double kSettled = 5.0;       // [s]
constexpr double kTenMinutes = 600.0;  // [s]
constexpr double kCreep = 0.01e-6;     // [m/s]

/// Scene (a)'s pinch, closed so far that friction could hold twice the cube's weight. Four fingers and a
/// thumb of stiffness k face each other: 4k and k in series.
PinchScene twice_the_friction_needed() {
  PinchScene pinch;
  const double friction = Material().static_friction;
  const double grip = 2.0 * pinch.mass * kGravity / friction;  // sum of the normal forces of both sides
  pinch.overlap = 0.25 * grip / (0.8 * pinch.stiffness);
  return pinch;
}

/// Average speed at which a cube moves in a still hand within ten minutes [m/s].
double creep(const Vector3& gravity) {
  const PinchScene pinch = twice_the_friction_needed();
  Configuration configuration = testing::implicit_configuration();
  configuration.gravity = gravity;
  Simulation simulation(pinch.scene(), configuration);
  Simulation weightless(pinch.scene(), testing::implicit_configuration());
  for (int frame = 0; frame < kRate; ++frame)
    weightless.advance({at(frame / kRate), {pinch.hand(frame / kRate, Vector3::Zero())}});
  simulation.set_state(weightless.state());
  Pose settled;
  const int frames = static_cast<int>((kSettled + kTenMinutes) * kRate);
  for (int frame = static_cast<int>(kRate); frame <= frames; ++frame) {
    const double t = frame / kRate;
    simulation.advance({at(t), {pinch.hand(t, Vector3::Zero())}});
    if (frame == static_cast<int>(kSettled * kRate)) settled = simulation.state().bodies[0].pose;
  }
  EXPECT_EQ(simulation.state().interactions[0].level, InteractionLevel::grasp);
  const Pose& pose = simulation.state().bodies[0].pose;
  const double corner = PinchScene().half * std::sqrt(3.0);
  return ((pose.position - settled.position).norm() +
          corner * pose.orientation.angularDistance(settled.orientation)) /
         kTenMinutes;
}

TEST(ImplicitCreep, a_pinched_cube_stays_where_it_is_for_ten_minutes_in_weightlessness) {
  const double speed = creep(Vector3::Zero());
  RecordProperty("creep_um_per_s", std::to_string(1e6 * speed));
  EXPECT_LE(speed, kCreep);
}

TEST(ImplicitCreep, a_pinched_cube_stays_where_it_is_for_ten_minutes_under_its_weight) {
  const double speed = creep(Vector3(0, 0, -kGravity));
  RecordProperty("creep_um_per_s", std::to_string(1e6 * speed));
  EXPECT_LE(speed, kCreep);
}

}  // namespace
}  // namespace mrhi
