#include <gtest/gtest.h>

#include "ros/result_messages.h"
#include "support/joints.h"

namespace mrhi {
namespace {

// A pendulum let go from 0.3 rad: its velocity is the change of its place, from frame to frame.
TEST(JointStates, tell_names_places_and_velocities_in_the_scenes_order) {
  Simulation simulation(testing::pendulum(2, 0.3, 9.81), Configuration());
  const auto at = [&](int milliseconds) {
    simulation.advance({testing::at(1e-3 * milliseconds), {}});
    return joint_states_message({simulation.scene(), simulation.result(), simulation.state()}, {});
  };
  const auto first = at(0);
  ASSERT_EQ(first.name, (std::vector<std::string>{"joint_0", "joint_1"}));
  EXPECT_NEAR(first.position[0], 0.3, 1e-9);
  EXPECT_NEAR(first.velocity[0], 0.0, 1e-9);
  for (int t = 1; t < 100; ++t) at(t);
  const auto before = at(100), now = at(101), after = at(102);
  for (const std::size_t joint : {0, 1}) {
    const double by_place = (after.position[joint] - before.position[joint]) / 0.002;
    EXPECT_NEAR(now.velocity[joint], by_place, 1e-4)
        << joint;  // the second difference: 1e-3 s squared times the jerk
  }
  EXPECT_LT(now.velocity[0], -0.1);
}

}  // namespace
}  // namespace mrhi
