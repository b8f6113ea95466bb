#include <gtest/gtest.h>

#include <algorithm>

#include "support/joints.h"

namespace mrhi {
namespace {

using testing::at;
using testing::box_body;
using testing::finger;

constexpr double kCube = 0.05;       // edge [m]
constexpr double kSlowRate = 100.0;  // [1/s]

Body block(const char* name, const Vector3& position) {
  Body body = box_body(Vector3::Constant(kCube), 0.1);
  body.name = name;
  body.start.position = position;
  return body;
}

/// A table, two cubes one on the other, and a ball high above them.
Scene standing_cubes() {
  Body table = box_body(Vector3(1.0, 1.0, 0.1), 1.0);
  table.name = "table";
  table.fixed = true;
  table.start.position.z() = -0.05;
  Scene scene = testing::scene_of(table);
  scene.gravity = Vector3(0, 0, -9.81);
  scene.bodies.push_back(block("lower", Vector3(0, 0, 0.5 * kCube)));
  scene.bodies.push_back(block("upper", Vector3(0.003, 0, 1.5 * kCube)));
  return scene;
}

struct Played {
  Played(Scene scene, bool sleep) : simulation(std::move(scene), configuration(sleep)) {}
  static Configuration configuration(bool sleep) {
    Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
    configuration.contact.sleep = sleep;
    return configuration;
  }
  void run(double until, const std::function<std::vector<Hand>(double)>& hands = nullptr) {
    for (; frame <= std::lround(until * kSlowRate); ++frame) {
      const double t = static_cast<double>(frame) / kSlowRate;
      simulation.advance({at(t), hands ? hands(t) : std::vector<Hand>()});
    }
  }
  void goes_on(const Played& from) {
    simulation.set_state(from.simulation.state());
    frame = from.frame;
  }
  bool asleep(std::size_t body) const { return simulation.state().asleep[body] != 0; }
  Vector3 place(std::size_t body) const { return simulation.state().bodies[body].pose.position; }

  Simulation simulation;
  long frame = 0;
};

/// A fingertip that pushes the upper cube off from 2 s on; which one of many decides how fast, and where on
/// its side.
std::vector<Hand> push(int which, double t) {
  const double speed = 0.15 + 0.003 * which;  // [m/s]
  const Vector3 tip(-0.3 + speed * std::max(t - 2.0, 0.0), 0.0004 * which, (1.4 + 0.01 * which) * kCube);
  return {finger(tip - Vector3(0, 0.01, 0), tip + Vector3(0, 0.01, 0), 0.008)};
}
std::vector<Hand> pushing(double t) {
  return push(0, t);
}

TEST(Sleeping, cubes_that_stand_still_sleep_where_they_stand) {
  Played sleeping(standing_cubes(), true), awake(standing_cubes(), false);
  sleeping.run(5.0);
  awake.run(5.0);
  for (const std::size_t cube : {1u, 2u}) {
    EXPECT_TRUE(sleeping.asleep(cube));
    EXPECT_FALSE(awake.asleep(cube));
    // Half a second at less than a micrometre per second.
    EXPECT_LT((sleeping.place(cube) - awake.place(cube)).norm(), 1e-6);
  }
  EXPECT_TRUE(sleeping.simulation.state().body_contacts.empty());
  EXPECT_FALSE(sleeping.simulation.state().sleeping_contacts.empty());
}

// They slept where they stood to 1e-12 m, and sliding by fits and starts makes more of that, now and then
// millimetres: on which step what slides holds or lets go is decided by the last bits. All agree over the
// first centimetre, most over all of their way.
// Less is what is about to fall; the cubes have settled within a tenth of a second.
TEST(Sleeping, begins_once_all_has_been_still_for_half_a_second_and_no_sooner) {
  Played played(standing_cubes(), true);
  played.run(0.45);
  EXPECT_FALSE(played.asleep(1) || played.asleep(2));
  played.run(0.9);
  EXPECT_TRUE(played.asleep(1) && played.asleep(2));
}

TEST(Sleeping, a_hand_that_comes_finds_them_awake_and_moves_them_as_if_they_had_not_slept) {
  constexpr int kPushes = 16;
  Played slept(standing_cubes(), true), waked(standing_cubes(), false);
  slept.run(2.5, pushing);
  waked.run(2.5, pushing);
  EXPECT_TRUE(slept.asleep(2));
  int same = 0;
  for (int which = 0; which < kPushes; ++which) {
    const auto pushing = [which](double t) { return push(which, t); };
    Played sleeping(standing_cubes(), true), awake(standing_cubes(), false);
    sleeping.goes_on(slept);
    awake.goes_on(waked);
    const auto apart = [&](std::size_t cube) { return (sleeping.place(cube) - awake.place(cube)).norm(); };
    for (double t = 2.5; awake.place(2).x() < 0.013 && t < 4.5; t += 1.0 / kSlowRate) {
      sleeping.run(t, pushing);
      awake.run(t, pushing);
    }
    EXPECT_GT(awake.place(2).x(), 0.013) << which;
    EXPECT_LT(std::max(apart(1), apart(2)), 1e-6) << which;
    sleeping.run(4.5, pushing);
    awake.run(4.5, pushing);
    EXPECT_GT(awake.place(2).x(), 0.05) << which;
    same += std::max(apart(1), apart(2)) < 1e-5;  // of 9 cm of sliding
  }
  EXPECT_GE(2 * same, kPushes);
  RecordProperty("same", same);
}

TEST(Sleeping, those_a_hand_has_woken_sleep_again_after_half_a_second_and_no_sooner) {
  // 7 mm beside the upper cube, from 2.0 to 2.1 s.
  const auto comes_near = [](double t) {
    const Vector3 tip(-0.04, 0, 1.5 * kCube);
    return t < 2.0 || t > 2.1 ? std::vector<Hand>() : std::vector<Hand>{finger(tip, tip, 0.008)};
  };
  Played played(standing_cubes(), true);
  played.run(1.99, comes_near);
  EXPECT_TRUE(played.asleep(1) && played.asleep(2));
  played.run(2.05, comes_near);
  EXPECT_FALSE(played.asleep(1) || played.asleep(2));
  played.run(2.48, comes_near);
  EXPECT_FALSE(played.asleep(1) || played.asleep(2));
  played.run(2.55, comes_near);
  EXPECT_TRUE(played.asleep(1) && played.asleep(2));
  EXPECT_TRUE(played.simulation.state().contacts.empty());
}

TEST(Sleeping, what_falls_on_a_sleeper_wakes_the_whole_pile) {
  const auto with_ball = [] {
    Scene scene = standing_cubes();
    Body ball = testing::ball_body(0.02, 0.2);
    ball.name = "ball";
    ball.start.position = Vector3(0.015, 0.0, 7.0);
    scene.bodies.push_back(ball);
    scene.bounds = {Vector3::Constant(-10.0), Vector3::Constant(10.0)};
    return scene;
  };
  Played sleeping(with_ball(), true), awake(with_ball(), false);
  sleeping.run(1.0);
  EXPECT_TRUE(sleeping.asleep(1) && sleeping.asleep(2));
  EXPECT_FALSE(sleeping.asleep(3));
  sleeping.run(1.3);
  awake.run(1.3);
  EXPECT_FALSE(sleeping.asleep(1) || sleeping.asleep(2));
  for (const std::size_t body : {1u, 2u, 3u})
    EXPECT_LT((sleeping.place(body) - awake.place(body)).norm(), 1e-4) << body;
}

TEST(Sleeping, slow_drift_is_never_put_to_rest) {
  Scene scene = standing_cubes();
  scene.gravity.setZero();
  scene.bodies[1].start.position.z() += 0.001;  // does not touch the table
  scene.bodies[1].start_twist.linear = Vector3(1e-7, 0, 0);
  scene.bodies[2].start.position.z() += 0.01;
  Played played(scene, true);
  played.run(10.0);
  EXPECT_FALSE(played.asleep(1));
  EXPECT_EQ(played.simulation.state().bodies[1].linear_momentum, Vector3(1e-8, 0, 0));
}

TEST(Sleeping, a_ball_that_rolls_a_millimetre_a_second_is_not_put_to_rest) {
  constexpr double kRadius = 0.03, kSpeed = 0.001;
  Scene scene = standing_cubes();
  scene.bodies.resize(1);
  Body ball = testing::ball_body(kRadius, 0.1);
  ball.start.position = {0, 0, kRadius};
  ball.start_twist = {{kSpeed, 0, 0}, {0, kSpeed / kRadius, 0}};
  scene.bodies.push_back(ball);
  Played played(scene, true);
  played.run(5.0);
  EXPECT_FALSE(played.asleep(1));
  EXPECT_NEAR(played.place(1).x(), 5.0 * kSpeed, 0.02 * 5.0 * kSpeed);
}

/// A drawer with friction, on the world, and a cube in it.
Scene drawer_with_cube() {
  Body drawer = box_body(Vector3(0.3, 0.3, 0.02), 1.0);
  drawer.name = "drawer";
  Scene scene = testing::scene_of(drawer);
  scene.gravity = Vector3(0, 0, -9.81);
  scene.bodies.push_back(block("cube", Vector3(0.05, 0, 0.01 + 0.5 * kCube)));
  scene.joints.push_back(testing::hinge(Joint::kWorld, 0, Pose(), Pose()));
  scene.joints[0].kind = JointKind::sliding;
  scene.joints[0].axis = Vector3::UnitX();
  scene.joints[0].friction = 0.5;
  return scene;
}

TEST(Sleeping, a_drawer_and_what_is_in_it_sleep_until_the_drawer_is_pushed) {
  Played sleeping(drawer_with_cube(), true), awake(drawer_with_cube(), false);
  const auto push = [](double t) {
    const Vector3 tip(-0.3 + 0.1 * std::max(t - 1.0, 0.0), 0, 0);  // at the drawer after 2.42 s
    return std::vector<Hand>{finger(tip - Vector3(0.03, 0, 0), tip, 0.008)};
  };
  sleeping.run(1.5, push);
  awake.run(1.5, push);
  EXPECT_TRUE(sleeping.asleep(0) && sleeping.asleep(1));
  sleeping.run(3.0, push);
  awake.run(3.0, push);
  EXPECT_GT(awake.place(1).x(), 0.08);
  for (const std::size_t body : {0u, 1u})
    EXPECT_LT((sleeping.place(body) - awake.place(body)).norm(), 1e-6) << body;
}

TEST(Sleeping, a_box_sleeps_on_a_table_with_its_lid) {
  Scene scene = standing_cubes();
  scene.bodies.resize(1);
  Body lid = box_body(Vector3(0.1, 0.05, 0.02), 0.1), box = box_body(Vector3(0.1, 0.05, 0.03), 0.2);
  lid.start.position.z() = 0.0401;
  scene.bodies.insert(scene.bodies.end(), {lid, box});
  const Pose below{{-0.05, 0, -0.0125}, Quaternion::Identity()}, above{{-0.05, 0, 0.0125}, below.orientation};
  scene.joints.push_back(testing::hinge(1, 2, below, above));
  scene.joints[0].lower = -1e-3, scene.joints[0].upper = 1e-3;
  Played played(scene, true);
  played.run(2.0);
  EXPECT_TRUE(played.asleep(1) && played.asleep(2));
}

TEST(Sleeping, a_linkage_wakes_as_a_whole) {
  Scene scene = testing::pendulum(4, 0.0, 0.0);
  for (Joint& joint : scene.joints) joint.friction = 0.05;
  Played played(scene, true);
  const auto all = [&](bool asleep) {
    for (std::size_t body = 0; body < 4; ++body) EXPECT_EQ(played.asleep(body), asleep) << body;
  };
  played.run(1.0);
  all(true);
  const Vector3 tip = scene.bodies[3].start.position;  // far from the first rod
  played.run(1.01, [&](double) { return std::vector<Hand>{finger(tip, tip + Vector3(0, 0.03, 0), 0.008)}; });
  all(false);
}

TEST(Sleeping, a_linkage_that_floats_or_hangs_freely_is_never_put_to_rest) {
  Scene floats = testing::pendulum(2, 0.0, 0.0), hangs = testing::pendulum(2, 1e-7, 9.81);
  floats.joints.erase(floats.joints.begin());
  for (Scene* scene : {&floats, &hangs}) scene->joints.back().friction = 0.05;
  floats.bodies[0].start_twist.linear = Vector3(1e-7, 0, 0);
  for (const Scene& scene : {floats, hangs}) {
    Played played(scene, true);
    played.run(3.0);
    EXPECT_FALSE(played.asleep(0) || played.asleep(1));
  }
}

TEST(Sleeping, a_copied_sleeper_wakes_with_the_same_bits) {
  Played first(standing_cubes(), true), second(standing_cubes(), true);
  first.run(2.5, pushing);
  second.goes_on(first);
  first.run(4.0, pushing);
  second.run(4.0, pushing);
  EXPECT_EQ(hash(first.simulation.state()), hash(second.simulation.state()));
}

}  // namespace
}  // namespace mrhi
