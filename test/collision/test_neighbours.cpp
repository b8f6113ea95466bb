#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "collision/closest_features.h"
#include "collision/neighbours.h"
#include "collision/overlap.h"
#include "random_capsules.h"
#include "support/joints.h"

namespace mrhi {
namespace {

Scene balls(Random& random, int count) {
  Scene scene;
  for (int i = 0; i < count; ++i) {
    scene.bodies.push_back(testing::ball_body(random.between(0.01, 0.06), 0.1));
    scene.bodies.back().start.position = random.in_box({0.15, 0.15, 0.15});
  }
  return scene;
}

HandTrack moving_hand(Random& random) {
  HandTrack track;
  track.active = true;
  for (std::size_t c = 0; c < kCapsules; ++c) {
    const double radius = random.below(5) == 0 ? 0.0 : 0.008;
    const Vector3 middle = random.in_box({0.2, 0.2, 0.2}), way = random.in_box({0.03, 0.03, 0.03});
    track.previous.capsules[c] = capsule_about(middle, 0.03 * random.direction(), 0.008);
    track.current.capsules[c] = capsule_about(middle + way, 0.03 * random.direction(), radius);
  }
  return track;
}

bool lists(const Neighbours& neighbours, int body, int capsule) {
  for (const NearBody& near : neighbours.near_hand(0)) {
    if (near.body == body) return std::find(near.begin(), near.end(), capsule) != near.end();
  }
  return false;
}

TEST(Neighbours, list_every_capsule_that_touches_a_body_on_its_way_and_not_all) {
  Random random(11);
  int touching = 0, listed = 0, all = 0;
  for (int round = 0; round < 200; ++round) {
    const Scene scene = balls(random, 5);
    std::vector<BodyState> bodies;
    for (const Body& body : scene.bodies) bodies.push_back(start_state(body));
    std::vector<HandTrack> hands(kMaxHands);
    hands[0] = moving_hand(random);
    Neighbours neighbours(scene);
    neighbours.begin_frame(hands, bodies);
    for (int body = 0; body < 5; ++body) {
      const auto b = static_cast<std::size_t>(body);
      const Sphere sphere{scene.bodies[b].bounding_radius};
      for (int capsule = 0; capsule < kCapsules; ++capsule) {
        const auto c = static_cast<std::size_t>(capsule);
        const bool is_listed = lists(neighbours, body, capsule);
        listed += is_listed, ++all;
        if (!hands[0].current.has(capsule)) continue;
        for (double fraction = 0.0; fraction <= 1.0; fraction += 0.125) {
          const Capsule now = blend(hands[0].previous, hands[0].current, fraction).capsules[c];
          const Vector3& centre = bodies[b].pose.position;
          const Capsule local{now.start - centre, now.end - centre, now.radius};
          if (capsule_sphere(local, sphere).distance > 0.0) continue;
          ++touching;
          ASSERT_TRUE(is_listed) << body << " " << capsule << " " << fraction;
          EXPECT_TRUE(neighbours.may_meet_hand(b, bodies[b], 0.0));
        }
      }
    }
  }
  EXPECT_GT(touching, 1000);
  EXPECT_LT(2 * listed, all);
}

TEST(Neighbours, tell_no_more_clearance_than_there_is_wherever_hand_and_body_are_in_the_frame) {
  Random random(12);
  int apart = 0;
  for (int round = 0; round < 300; ++round) {
    Body body = testing::box_body(Vector3(0.05, 0.02, 0.08), 0.1);
    body.start = {random.in_box({0.15, 0.15, 0.15}), Quaternion(Eigen::AngleAxisd(1.0, random.direction()))};
    const Scene scene = testing::scene_of(body);
    const Box& box = std::get<Box>(scene.bodies[0].shapes[0].shape);
    const std::vector<BodyState> bodies{start_state(scene.bodies[0])};
    std::vector<HandTrack> hands(kMaxHands);
    hands[0] = moving_hand(random);
    Neighbours neighbours(scene);
    neighbours.begin_frame(hands, bodies);
    Pose pose = bodies[0].pose;
    pose.position += 0.001 * random.direction();
    pose.orientation = Quaternion(Eigen::AngleAxisd(0.02, random.direction())) * pose.orientation;
    for (const NearBody& near : neighbours.near_hand(0)) {
      for (std::size_t i = 0; i < static_cast<std::size_t>(near.count); ++i) {
        const double told = near.clearances[i] - near.moved(pose, scene.bodies[0].bounding_radius);
        apart += told > 0.0;
        for (double fraction = 0.0; fraction <= 1.0; fraction += 0.125) {
          const Capsule now = blend(hands[0].previous, hands[0].current, fraction).capsules[near.capsules[i]];
          const Capsule local{pose.to_local(now.start), pose.to_local(now.end), now.radius};
          ASSERT_GE(capsule_box(local, box).distance, told - 1e-12) << round << " " << fraction;
        }
      }
    }
  }
  EXPECT_GT(apart, 100);
}

TEST(BoxAround, holds_all_shapes_of_a_body_and_no_more) {
  Body body = testing::box_body(Vector3(0.02, 0.04, 0.06), 0.1);
  const Quaternion quarter_about_x(Eigen::AngleAxisd(M_PI / 2.0, Vector3::UnitX()));
  body.shapes.push_back({Cylinder{0.01, 0.05}, {Vector3(0.1, 0, 0), quarter_about_x}});
  body.shapes.push_back({Sphere{0.01}, {Vector3(0, 0, 0.05), quarter_about_x}});
  const Eigen::AlignedBox3d box = box_around(body);
  EXPECT_LE((box.min() - Vector3(-0.01, -0.05, -0.03)).norm(), 1e-15);
  EXPECT_LE((box.max() - Vector3(0.11, 0.05, 0.06)).norm(), 1e-15);
}

// Except those that a joint connects, which may overlap.
TEST(OverlapsInMechanisms, are_all_listed) {
  Scene scene;
  for (int i = 0; i < 4; ++i) {
    Body body = testing::box_body(Vector3::Constant(0.1), 0.1);
    body.name = "link" + std::to_string(i);
    scene.bodies.push_back(body);
    if (i > 0) scene.joints.push_back(testing::hinge(i - 1, i, Pose(), Pose(), 0.0));
  }
  std::set<std::pair<int, int>> pairs;
  for (const auto& [a, b] : overlaps_in_mechanisms(scene)) pairs.insert(std::minmax(a, b));
  EXPECT_EQ(pairs, (std::set<std::pair<int, int>>{{0, 2}, {0, 3}, {1, 3}}));
}

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
    std::vector<std::pair<int, int>> touching, pairs = broad_phase.pairs();
    for (int i = 0; i < static_cast<int>(balls.size()); ++i)
      for (int j = i + 1; j < static_cast<int>(balls.size()); ++j)
        if ((balls[i].centre - balls[j].centre).norm() <= balls[i].radius + balls[j].radius)
          touching.emplace_back(i, j);
    std::sort(pairs.begin(), pairs.end());
    ASSERT_EQ(pairs, touching) << round;
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
