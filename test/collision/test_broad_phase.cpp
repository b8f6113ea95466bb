#include <gtest/gtest.h>

#include "collision/neighbours.h"
#include "random_capsules.h"

namespace mrhi {
namespace {

struct Ball {
  Vector3 centre;
  double radius;
};

TEST(BroadPhase, finds_what_an_exhaustive_search_finds) {
  Random random(7);
  std::vector<Ball> balls(60);
  BroadPhase broad_phase(balls.size());
  int found = 0;
  for (int round = 0; round < 300; ++round) {
    for (std::size_t i = 0; i < balls.size(); ++i) {
      if (round > 0 && random.below(3) == 0) continue;  // some stay
      balls[i] = {random.in_box({1, 1, 1}), random.between(0.01, 0.2)};
      broad_phase.update(static_cast<int>(i), balls[i].centre, balls[i].radius);
    }
    for (int query = 0; query < 5; ++query) {
      const Vector3 middle = random.in_box({1, 1, 1});
      const Vector3 half = random.in_box({0.15, 0.15, 0.15}).cwiseAbs();
      std::vector<int> expected;
      for (std::size_t i = 0; i < balls.size(); ++i) {
        const Vector3 apart = (balls[i].centre - middle).cwiseAbs() - half;
        if (apart.maxCoeff() <= balls[i].radius) expected.push_back(static_cast<int>(i));
      }
      ASSERT_EQ(broad_phase.query(middle - half, middle + half), expected) << round;
      found += static_cast<int>(expected.size());
    }
  }
  EXPECT_GT(found, 300);
}

TEST(BroadPhase, bodies_not_placed_are_not_found) {
  BroadPhase broad_phase(3);
  EXPECT_TRUE(broad_phase.query(-Vector3::Ones(), Vector3::Ones()).empty());
  broad_phase.update(1, Vector3::Zero(), 0.1);
  EXPECT_EQ(broad_phase.query(-Vector3::Ones(), Vector3::Ones()), std::vector<int>{1});
}

TEST(BroadPhase, survives_a_move) {
  BroadPhase first(2);
  first.update(0, Vector3::Zero(), 0.1);
  BroadPhase second(std::move(first));
  second.update(1, Vector3::Ones(), 0.1);
  EXPECT_EQ(second.query(-Vector3::Ones(), Vector3::Ones()), (std::vector<int>{0, 1}));
}

TEST(BroadPhase, no_bodies_is_no_error) {
  BroadPhase broad_phase(0);
  EXPECT_TRUE(broad_phase.query(-Vector3::Ones(), Vector3::Ones()).empty());
}

}  // namespace
}  // namespace mrhi
