#include <gtest/gtest.h>

#include "support/fixtures.h"

namespace mrhi {
namespace {

using testing::at;

constexpr double kRadius = 0.02, kGap = 0.02, kFrom = -0.04, kSpeed = 2.0;

Body ball_at(const char* name, const Vector3& place) {
  Body ball = testing::ball_body(kRadius, 0.1);
  ball.name = name;
  ball.start.position = place;
  return ball;
}

Body tumbling(const Vector3& place) {
  Body box = testing::box_body(Vector3(0.05, 0.04, 0.03), 0.1);
  box.name = "box";
  box.start.position = place;
  box.start_twist = {{0.3, -0.2, 0.1}, {9, 3, -5}};
  return box;
}

Scene scene_of_two(const Body& first, const Body& second) {
  Scene scene = testing::scene_of(first);
  scene.bodies.push_back(second);
  return scene;
}

TEST(IsolatedBodies, beside_a_hand_that_is_busy_a_body_ends_where_it_would_by_itself_to_the_bit) {
  const Hand near = testing::finger({-0.03, 0, 0.032}, {0.03, 0, 0.032}, 0.001);
  Simulation busy(scene_of_two(testing::ball_body(0.03, 0.1), tumbling({1, 0, 0})), testing::unfiltered());
  Simulation by_itself(testing::scene_of(tumbling({1, 0, 0})), testing::unfiltered());
  for (int i = 0; i < 100; ++i) {
    int steps = 0;
    ASSERT_EQ(busy.begin({at(0.01 * i), {near}}), Rejection::none);
    while (busy.step()) ++steps;
    busy.end();
    by_itself.advance({at(0.01 * i), {}});
    EXPECT_EQ(steps, i == 0 ? 0 : 10) << "because of the hand";
  }
  const BodyState &ends = busy.state().bodies[1], &wanted = by_itself.state().bodies[0];
  EXPECT_EQ(ends.pose.position, wanted.pose.position);
  EXPECT_EQ(ends.pose.orientation.coeffs(), wanted.pose.orientation.coeffs());
  EXPECT_EQ(ends.angular_momentum, wanted.angular_momentum);
}

/// A finger strikes a ball, which flies on at one that nothing was near as the frame began, and which drifts
/// and spins.
SimulationState struck(double frame) {
  Scene scene = scene_of_two(ball_at("first", {0, 0, 0}), ball_at("second", {2 * kRadius + kGap, 0, 0}));
  scene.bodies[1].start_twist = {{0, 0.1, 0.05}, {0, 0, 8}};
  Configuration configuration = testing::unfiltered();
  configuration.contact.grasp_assist = false;
  Simulation simulation(scene, configuration);
  const int frames = static_cast<int>(std::lround(0.06 / frame));
  for (int i = 0; i <= frames; ++i) {
    const double t = i * frame, x = kFrom + kSpeed * (t - 0.02);
    simulation.advance({at(t), {testing::finger({x, -0.03, 0}, {x, 0.03, 0}, 0.008)}});
  }
  return simulation.state();
}

TEST(IsolatedBodies, what_is_struck_towards_a_body_within_the_frame_meets_it_where_it_is_by_then) {
  const SimulationState once = struck(0.02), often = struck(0.001);
  EXPECT_GT(often.bodies[1].linear_momentum.x(), 0.1) << "the second was hit";
  for (std::size_t b = 0; b < 2; ++b) {
    // Rounding alone: both go by steps of 1 ms.
    EXPECT_LT((once.bodies[b].pose.position - often.bodies[b].pose.position).norm(), 1e-9) << b;
    EXPECT_LT((once.bodies[b].linear_momentum - often.bodies[b].linear_momentum).norm(), 1e-9) << b;
    EXPECT_LT((once.bodies[b].angular_momentum - often.bodies[b].angular_momentum).norm(), 1e-11) << b;
  }
}

}  // namespace
}  // namespace mrhi
