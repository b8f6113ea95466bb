#include <gtest/gtest.h>

#include "support/fixtures.h"

namespace mrhi {
namespace {

using testing::at;

Simulation quiet(double step) {
  Configuration configuration = testing::unfiltered();
  configuration.step = step;
  return Simulation(testing::scene_of(testing::ball_body(0.03, 0.1)), configuration);
}

TEST(Time, goes_on_by_equal_steps_from_one_frame_to_the_next) {
  Simulation simulation = quiet(0.002);
  const Hand near = testing::finger({-0.03, 0, 0.032}, {0.03, 0, 0.032}, 0.001);  // so that steps are needed
  simulation.advance({at(-0.01), {near}});
  simulation.advance({at(0.0), {near}});
  EXPECT_EQ(simulation.time(), at(0.0));
  ASSERT_EQ(simulation.begin({at(0.01), {near}}), Rejection::none);
  EXPECT_EQ(simulation.time(), at(0.0));
  for (int i = 1; i <= 5; ++i) {
    ASSERT_TRUE(simulation.step());
    EXPECT_EQ(simulation.time(), at(0.002 * i)) << i;
  }
  ASSERT_FALSE(simulation.step());
  simulation.end();
  EXPECT_EQ(simulation.time(), at(0.01));
}

TEST(Time, is_that_of_a_state_which_has_been_put_in) {
  Simulation simulation = quiet(0.002);
  simulation.advance({at(0.0), {}});
  simulation.advance({at(0.01), {}});
  const SimulationState early = simulation.state();
  simulation.advance({at(0.02), {}});
  simulation.set_state(early);
  EXPECT_EQ(simulation.time(), at(0.01));
}

TEST(Time, goes_on_without_hands_too) {
  Simulation simulation = quiet(0.002);
  simulation.advance({at(0.0), {}});
  ASSERT_TRUE(simulation.advance_without_hands(at(1.0)));
  EXPECT_EQ(simulation.time(), at(1.0));
}

}  // namespace
}  // namespace mrhi
