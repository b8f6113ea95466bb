#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "support/grips.h"

namespace mrhi {
namespace {

using testing::at;
using testing::ball_body;
using testing::box_body;

constexpr double kGravity = 9.81;  // [m/s^2]

/// Objects by themselves: the simulation is advanced by frames without hands.
class Objects {
 public:
  explicit Objects(Scene scene, double step = 0.001)
      : simulation_(wide(std::move(scene)), configuration(step)), frame_(std::max(step, 0.001)) {
    simulation_.advance({at(0.0), {}});
  }

  void run(double seconds, const std::function<void()>& each = nullptr) {
    const long last = count_ + std::lround(seconds / frame_);
    while (count_ < last) {
      simulation_.advance({at(static_cast<double>(++count_) * frame_), {}});
      if (each) each();
    }
  }
  const BodyState& state(std::size_t body) const { return simulation_.state().bodies[body]; }
  Twist twist(std::size_t body) const { return testing::object_twist(simulation_, body); }
  const Simulation& simulation() const { return simulation_; }

  Vector3 momentum() const {
    Vector3 sum = Vector3::Zero();
    for (const BodyState& state : simulation_.state().bodies) sum += state.linear_momentum;
    return sum;
  }
  Vector3 angular_momentum() const {
    Vector3 sum = Vector3::Zero();
    for (const BodyState& state : simulation_.state().bodies)
      sum += state.pose.position.cross(state.linear_momentum) + state.angular_momentum;
    return sum;
  }
  double energy() const {
    double sum = 0.0;
    for (std::size_t b = 0; b < simulation_.scene().bodies.size(); ++b)
      sum += kinetic_energy(simulation_.scene().bodies[b], state(b));
    return sum;
  }

 private:
  static Scene wide(Scene scene) {
    scene.bounds = {Vector3::Constant(-100.0), Vector3::Constant(100.0)};
    return scene;
  }
  static Configuration configuration(double step) {
    Configuration configuration = testing::implicit_configuration();
    configuration.contact.sleep = false;  // the law itself is tried here
    configuration.step = step;
    return configuration;
  }
  Simulation simulation_;
  double frame_;
  long count_ = 0;
};

Body placed(Body body, const std::string& name, const Vector3& position,
            const Vector3& velocity = Vector3::Zero(), const Vector3& spin = Vector3::Zero()) {
  body.name = name;
  body.start.position = position;
  body.start_twist = {velocity, spin};
  return body;
}

Body with(Body body, double restitution, double friction) {
  body.material.restitution = restitution;
  body.material.static_friction = body.material.dynamic_friction = friction;
  return body;
}

Body floor_block(double friction) {
  Body block =
      placed(with(box_body(Vector3(2.0, 2.0, 0.1), 1.0), 0.0, friction), "floor", Vector3(0, 0, -0.05));
  block.fixed = true;
  return block;
}

Scene of(std::vector<Body> bodies, double gravity = 0.0) {
  Scene scene;
  scene.name = "objects";
  scene.bodies = std::move(bodies);
  scene.gravity = Vector3(0, 0, -gravity);
  return scene;
}

TEST(ObjectsTouch, elastic_balls_exchange_velocity_in_a_head_on_blow) {
  const Body ball = with(ball_body(0.03, 0.2), 1.0, 0.0);
  Objects balls(
      of({placed(ball, "a", Vector3(-0.1, 0, 0), Vector3(1, 0, 0)), placed(ball, "b", Vector3(0.1, 0, 0))}));
  balls.run(0.5);
  EXPECT_NEAR(balls.twist(0).linear.x(), 0.0, 1e-12);
  EXPECT_NEAR(balls.twist(1).linear.x(), 1.0, 1e-12);
  // Where they would be had each passed through the other: the blow fell at its own time.
  EXPECT_NEAR(balls.state(1).pose.position.x(), 0.4 + 0.06, 1e-6);
}

/// A cloud of balls of several sizes and masses that meet again and again.
Scene cloud() {
  std::vector<Body> balls;
  for (int i = 0; i < 12; ++i) {
    const double radius = 0.02 + 0.002 * (i % 4), mass = 0.05 * (1 + i % 3);
    const Vector3 place(0.09 * (i % 3 - 1), 0.09 * (i / 3 % 2), 0.09 * (i / 6));
    const Vector3 velocity = Vector3(-1.0 - 0.1 * i, 0.7, 0.4 - 0.05 * i).cwiseProduct(place) * 6.0;
    balls.push_back(
        placed(with(ball_body(radius, mass), 1.0, 0.0), "ball" + std::to_string(i), place, velocity));
  }
  return of(balls);
}

TEST(ObjectsTouch, elastic_balls_keep_momentum_energy_and_what_spin_they_have_at_any_step) {
  for (const double step : {0.00025, 0.001, 0.004, 0.0083333333, 0.0166666667}) {
    Objects balls(cloud(), step);
    const Vector3 momentum = balls.momentum(), angular_momentum = balls.angular_momentum();
    const double energy = balls.energy();
    int blows = 0;
    balls.run(1.0, [&] {
      for (const BodyContact& contact : balls.simulation().state().body_contacts)
        blows += contact.impulse.norm() > 0.0 ? 1 : 0;
    });
    EXPECT_GE(blows, 2) << step;  // as seen at the frames' ends
    EXPECT_NEAR((balls.momentum() - momentum).norm(), 0.0, 1e-12 * energy) << step;
    EXPECT_NEAR((balls.angular_momentum() - angular_momentum).norm(), 0.0, 1e-9 * energy) << step;
    EXPECT_NEAR(balls.energy() / energy, 1.0, 1e-9) << step;
    for (std::size_t b = 0; b < balls.simulation().scene().bodies.size(); ++b)
      EXPECT_LT(balls.twist(b).angular.norm(), 1e-9) << step;  // [rad/s]: nothing rubs
  }
}

// Within a step of impact the boxes rotate by up to 9 mrad, in which their inertia turns. With the inertia of
// the step's start they gained up to 0.2 % in steps of 1 ms; the rotation's second order remains.
TEST(ObjectsTouch, elastic_boxes_that_spin_keep_their_energy) {
  std::mt19937 random(3);
  const auto number = [&] { return std::uniform_real_distribution<double>(-1.0, 1.0)(random); };
  const auto vector = [&] {
    const double x = number(), y = number();
    return Vector3(x, y, number());
  };
  int hits = 0;
  for (int i = 0; i < 40; ++i) {
    Body a = placed(with(box_body(Vector3(0.05, 0.04, 0.06), 0.1), 1.0, 0.0), "a", Vector3::Zero(),
                    0.2 * vector());
    const Vector3 apart(0.12, 0.03 * number(), 0.03 * number());
    Body b = placed(with(box_body(Vector3(0.03, 0.05, 0.04), 0.05), 1.0, 0.0), "b", apart, -4.0 * apart);
    a.start_twist.angular = 5.0 * vector(), b.start_twist.angular = 5.0 * vector();
    for (const double step : {0.00025, 0.001}) {
      Objects boxes(of({a, b}), step);
      const double energy = boxes.energy(), speed = boxes.twist(0).linear.norm();
      boxes.run(0.6);
      EXPECT_NEAR(boxes.energy() / energy, 1.0, 1e-4) << i << " " << step;
      hits += std::abs(boxes.twist(0).linear.norm() - speed) > 1e-6 ? 1 : 0;
    }
  }
  EXPECT_GE(hits, 60);
}

TEST(ObjectsTouch, a_smooth_ball_bounces_off_at_the_angle_it_came_without_spin) {
  for (const double step : {0.001, 0.004, 0.0083333333}) {
    Body floor = floor_block(0.0);
    floor.material.restitution = 1.0;
    Objects objects(of({floor, placed(with(ball_body(0.03, 0.2), 1.0, 0.0), "ball", Vector3(-0.2, 0, 0.08),
                                      Vector3(1.0, 0, -0.3))}),
                    step);
    objects.run(0.4);
    EXPECT_NEAR((objects.twist(1).linear - Vector3(1.0, 0, 0.3)).norm(), 0.0, 1e-9) << step;
    EXPECT_LT(objects.twist(1).angular.norm(), 1e-9) << step;
  }
}

TEST(ObjectsTouch, a_blow_goes_through_a_row_of_balls_that_touch) {
  const Body ball = with(ball_body(0.02, 0.1), 1.0, 0.0);
  for (const double step : {0.001, 0.0083333333}) {
    std::vector<Body> row{placed(ball, "striker", Vector3(-0.2, 0, 0), Vector3(1, 0, 0))};
    for (int i = 0; i < 4; ++i)
      row.push_back(placed(ball, "ball_" + std::to_string(i), Vector3(0.04 * i, 0, 0)));
    Objects cradle(of(row), step);
    cradle.run(0.5);
    for (std::size_t b = 0; b < 4; ++b) EXPECT_NEAR(cradle.twist(b).linear.norm(), 0.0, 1e-9) << b;
    EXPECT_NEAR(cradle.twist(4).linear.x(), 1.0, 1e-9) << step;
  }
}

// A ball is met from the left, 0.15 ms later from the right by one twice as heavy, and then finds the first
// one again. Were blows of one step dealt at once, they would end at -1.5, -0.5 and 0.5 m/s.
TEST(ObjectsTouch, blows_of_one_step_follow_each_other_in_time) {
  const Body ball = with(ball_body(0.03, 0.2), 1.0, 0.0), heavy = with(ball_body(0.03, 0.4), 1.0, 0.0);
  Objects balls(of({placed(ball, "left", Vector3(-0.0602, 0, 0), Vector3(1, 0, 0)),
                    placed(ball, "middle", Vector3::Zero()),
                    placed(heavy, "right", Vector3(0.0605, 0, 0), Vector3(-1, 0, 0))}));
  balls.run(0.001);
  EXPECT_NEAR(balls.twist(0).linear.x(), -5.0 / 3.0, 1e-12);
  EXPECT_NEAR(balls.twist(1).linear.x(), 0.0, 1e-12);
  EXPECT_NEAR(balls.twist(2).linear.x(), 1.0 / 3.0, 1e-12);
}

TEST(ObjectsTouch, rough_spinning_boxes_keep_linear_and_angular_momentum_and_lose_energy) {
  const Body box = with(box_body(Vector3(0.06, 0.05, 0.04), 0.1), 0.5, 0.6);
  Objects boxes(of({placed(box, "a", Vector3(-0.08, 0.01, 0), Vector3(0.5, 0, 0), Vector3(3, -2, 1)),
                    placed(box, "b", Vector3(0.08, 0, 0.01), Vector3(-0.4, 0, 0), Vector3(0, 4, -2))}));
  const Vector3 momentum = boxes.momentum(), turning = boxes.angular_momentum();
  const double energy = boxes.energy();
  boxes.run(0.6);
  EXPECT_LT(boxes.energy(), 0.95 * energy);
  EXPECT_NEAR((boxes.momentum() - momentum).norm(), 0.0, 1e-14);
  EXPECT_NEAR((boxes.angular_momentum() - turning).norm() / turning.norm(), 0.0, 1e-12);
}

TEST(ObjectsTouch, a_stack_of_three_cubes_stands_for_a_minute) {
  const Body cube = with(box_body(Vector3::Constant(0.05), 0.1), 0.3, 0.8);
  std::vector<Body> bodies{floor_block(0.8)};
  for (int i = 0; i < 3; ++i)
    bodies.push_back(
        placed(cube, "cube" + std::to_string(i), Vector3(0.002 * i, -0.003 * i, 0.025 + 0.0501 * i)));
  Objects stack(of(bodies, kGravity));
  stack.run(1.0);
  std::vector<BodyState> settled = stack.simulation().state().bodies;
  stack.run(59.0);
  for (std::size_t b = 1; b <= 3; ++b) {
    const Pose& now = stack.state(b).pose;
    EXPECT_NEAR((now.position - settled[b].pose.position).norm(), 0.0, 1e-6) << b;
    EXPECT_NEAR(now.orientation.angularDistance(settled[b].pose.orientation), 0.0, 1e-5) << b;
    // Springs of 1e7 N/m carry at most 3 N each: the stack gives by less than a micrometre.
    EXPECT_NEAR(now.position.z(), 0.025 + 0.05 * static_cast<double>(b - 1), 1e-6) << b;
  }
}

// The springs of a milligram are so stiff beside it that friction is a leap: a search along it that was cut
// short let this cube leave at 0.66 m/s.
TEST(ObjectsTouch, a_cube_of_a_millimetre_gains_no_energy_as_it_lands) {
  Configuration configuration = testing::implicit_configuration();
  configuration.contact.object_stiffness = 1e9;
  Body cube = placed(with(box_body(Vector3::Constant(0.001), 1e-6), 0.3, 0.8), "cube", {0, 0, 0.0008},
                     {0.05, 0.01, 0}, {3, 5, 7});
  Scene scene = of({floor_block(0.8), cube}, kGravity);
  scene.bounds = {Vector3::Constant(-1.0), Vector3::Constant(1.0)};
  Simulation simulation(scene, configuration);
  double least = 1.0;
  for (int i = 0; i <= 1000; ++i) {
    simulation.advance({at(0.001 * i), {}});
    const BodyState& state = simulation.state().bodies[1];
    const double energy = kinetic_energy(cube, state) + cube.mass * kGravity * state.pose.position.z();
    // A corner that comes down beside one that rests lets it sink in by 14 um for a moment, of the centre's
    // 500: that much of the energy comes back.
    EXPECT_LE(energy, 1.03 * least) << i;
    least = std::min(least, energy);
  }
}

TEST(ObjectsTouch, a_cube_slides_on_a_fixture_as_far_as_coulomb_lets_it) {
  const double friction = 0.4, speed = 1.0;
  const Body cube = with(box_body(Vector3::Constant(0.05), 0.1), 0.0, friction);
  for (const double step : {0.00025, 0.001, 0.004, 1.0 / 60.0}) {
    Objects slide(of({floor_block(friction),
                      placed(cube, "cube", Vector3(-0.5, 0, 0.025 - 2.4525e-6 * 4), Vector3(speed, 0, 0))},
                     kGravity),
                  step);
    slide.run(1.0);
    const double way = slide.state(1).pose.position.x() + 0.5;
    // Friction acts with the velocity at each step's end, which leaves v h / 2 out.
    EXPECT_NEAR(way, speed * speed / (2.0 * friction * kGravity) - 0.5 * speed * step, 0.001) << step;
    EXPECT_NEAR(slide.twist(1).linear.norm(), 0.0, 1e-6) << step;
    if (step > 0.001) continue;
    EXPECT_NEAR(way / (speed * speed / (2.0 * friction * kGravity)), 1.0, 0.01);
  }
}

/// Time of the ramp tests, from the drop [s].
constexpr double kRampTime = 2.0;

/// Speed along a ramp kRampTime after a block with mu 0.8 and phi 0.6 was dropped on it.
double speed_on_ramp(double degrees, double drop, double step, double restitution = 0.0) {
  Body floor = with(box_body(Vector3(4.0, 4.0, 0.1), 1.0), restitution, 0.8);
  floor.fixed = true;
  Body block = with(box_body(Vector3::Constant(0.05), 0.1), restitution, 0.8);
  for (Body* body : {&floor, &block}) body->material.dynamic_friction = 0.6;
  const double angle = degrees * testing::kDegrees;
  Scene scene = of({placed(floor, "floor", Vector3(0, 0, -0.05), Vector3::Zero()),
                    placed(block, "block", Vector3(0, 0, 0.025 + drop), Vector3::Zero())});
  scene.gravity = kGravity * Vector3(std::sin(angle), 0, -std::cos(angle));
  Objects objects(scene, step);
  objects.run(kRampTime);
  return objects.twist(1).linear.x();
}

// tan 38.66 degrees = 0.8. By corners that slip one after the other a block slid from 37.8 (36 at 0.25 ms)
// on, and once it had landed from 31 on, where 0.6 no longer holds it.
TEST(ObjectsTouch, a_block_sticks_on_a_ramp_up_to_its_static_friction_however_it_landed) {
  for (const double step : {0.00025, 0.001, 1.0 / 120.0}) {
    for (const double drop : {0.0, 1e-4, 1e-3, 0.02}) {
      EXPECT_LT(speed_on_ramp(38.46, drop, step), 1e-4) << step << " " << drop;
      EXPECT_GT(speed_on_ramp(38.86, drop, step), 0.05) << step << " " << drop;
    }
  }
}

// A block that bounces lands obliquely: each flight of 2 e v / g cos gives it 2 e v tan along the ramp, and
// the next impact takes mu (1 + e) e v at most. At 35 degrees and e = 0.3 the bounces leave 2 cm/s, and from
// then on phi 0.6 < tan 35 does not hold it. Within 2 %: the last bounces are shorter than a step.
TEST(ObjectsTouch, a_block_that_bounces_slides_on_at_the_speed_that_its_bounces_leave) {
  const double restitution = 0.3, drop = 0.001, angle = 35.0 * testing::kDegrees;
  const double down = kGravity * std::cos(angle), along = kGravity * std::sin(angle);
  double time = std::sqrt(2.0 * drop / down), approach = down * time, speed = along * time;
  for (; approach > 1e-6; approach *= restitution) {
    speed = std::max(0.0, speed - 0.8 * (1.0 + restitution) * approach);
    const double flight = 2.0 * restitution * approach / down;
    speed += along * flight;
    time += flight;
  }
  EXPECT_GT(speed, 0.01);  // friction is static up to here
  const double expected = speed + (along - 0.6 * down) * (kRampTime - time);
  for (const double step : {0.00025, 0.001})
    EXPECT_NEAR(speed_on_ramp(35.0, drop, step, restitution), expected, 0.02 * expected) << step;
}

TEST(ObjectsTouch, two_unlike_bodies_rub_by_the_geometric_mean_of_their_frictions) {
  const double step = 0.00025;
  const Body cube = with(box_body(Vector3::Constant(0.05), 0.1), 0.0, 0.2);
  Objects slide(
      of({floor_block(0.8), placed(cube, "cube", Vector3(-0.5, 0, 0.025 - 9.81e-6), Vector3(1, 0, 0))},
         kGravity),
      step);
  slide.run(1.0);
  const double way = slide.state(1).pose.position.x() + 0.5;
  EXPECT_NEAR(way, 1.0 / (2.0 * 0.4 * kGravity) - 0.5 * step, 0.001) << "of 0.2 and 0.8 it is 0.4";
}

TEST(ObjectsTouch, a_ball_rolls_on_without_loss) {
  const double radius = 0.03, speed = 0.5;
  const Body ball = with(ball_body(radius, 0.1), 0.0, 0.8);
  Objects roll(of({floor_block(0.8), placed(ball, "ball", Vector3(-0.5, 0, radius - 0.981e-5),
                                            Vector3(speed, 0, 0), Vector3(0, speed / radius, 0))},
                  kGravity));
  roll.run(1.0);
  EXPECT_NEAR(roll.twist(1).linear.x(), speed, 1e-3 * speed);
  EXPECT_NEAR(roll.twist(1).angular.y(), speed / radius, 1e-3 * speed / radius);
}

TEST(ObjectsTouch, a_ball_dropped_without_loss_comes_back_to_its_height) {
  const double radius = 0.03;
  Body ball = with(ball_body(radius, 0.1), 1.0, 0.0);
  Body ground = floor_block(0.0);
  ground.material.restitution = 1.0;
  for (const double step : {0.001, 0.004}) {
    Objects bounce(of({ground, placed(ball, "ball", Vector3(0, 0, radius + 0.3))}, kGravity), step);
    double highest = 0.0;
    const double period = 2.0 * std::sqrt(2.0 * 0.3 / kGravity);
    bounce.run(3.5 * period);
    bounce.run(0.6 * period, [&] { highest = std::max(highest, bounce.state(1).pose.position.z()); });
    // Between two steps the highest point can be missed by g h^2 / 8.
    EXPECT_NEAR(highest, radius + 0.3, 1e-4) << step;
  }
}

TEST(ObjectsTouch, three_bodies_in_a_row_are_pushed_by_a_finger_as_one) {
  const Body cube = with(box_body(Vector3::Constant(0.05), 0.1), 0.0, 0.8);
  std::vector<Body> row;
  for (int i = 0; i < 3; ++i)
    row.push_back(placed(cube, "cube" + std::to_string(i), Vector3(0.05 * i, 0, 0)));
  Scene scene = of(row);
  Simulation simulation(scene, testing::implicit_configuration());
  const auto hand_at = [](double t) {
    Hand hand = testing::empty_hand();
    testing::add_fingertip(hand, capsule_index(1, 3), Vector3(-0.025 - 0.01 + 0.1 * t, 0, 0),
                           -Vector3::UnitX());
    return hand;
  };
  testing::play(simulation, 0.0, 1.0, 1000.0, hand_at);
  // The finger's spring gives back part of what it took up: the row leaves faster than the finger comes,
  // twice as fast at most.
  const double speed = testing::object_twist(simulation, 0).linear.x();
  EXPECT_GE(speed, 0.1);
  EXPECT_LE(speed, 0.2);
  for (std::size_t b = 1; b < 3; ++b)
    EXPECT_NEAR(testing::object_twist(simulation, b).linear.x(), speed, 1e-4);
  EXPECT_GT(simulation.state().bodies[2].pose.position.x(), 0.1 + 0.05);
}

TEST(ObjectsTouch, a_held_cube_carries_another_on_top_of_it) {
  const testing::PinchScene pinch;
  Scene scene = pinch.scene();
  Body rider = box_body(Vector3::Constant(0.04), 0.03);
  scene.bodies.push_back(placed(rider, "rider", Vector3(0, 0, 0.025 + 0.02)));
  Configuration configuration = testing::implicit_configuration();
  Simulation simulation(scene, configuration);
  const auto sway = [](double t) -> Vector3 {
    const double x = std::max(0.0, t - 0.5);
    return testing::smooth(x, 0.5) * testing::swing(x, 0.004, 0.5) + 0.5 * 0.5 * x * x * Vector3::UnitZ();
  };
  // Pressed on by half a metre per second squared upwards: less than friction needs for the swing sideways.
  testing::play(simulation, 0.0, 1.5, 1000.0, [&](double t) { return pinch.hand(t, sway(t)); });
  const BodyState &cube = simulation.state().bodies[0], &top = simulation.state().bodies[1];
  EXPECT_NEAR((top.pose.position - cube.pose.position - Vector3(0, 0, 0.045)).norm(), 0.0, 2e-3);
}

/// Bodies listed the other way round are the same scene.
/// How deep a bar that turns fast gets into a ball in its way at most, by steps in which its end moves by
/// more than the ball's radius [m].
double deepest_of_a_blow_by_turning(bool bar_first) {
  const Vector3 half(0.005, 0.1, 0.005);
  constexpr double kRadius = 0.01;
  Body bar = placed(with(box_body(2.0 * half, 0.2), 0.5, 0.0), "bar", Vector3::Zero());
  bar.start_twist.angular = Vector3(0.0, 0.0, 30.0);
  const Body ball = placed(with(ball_body(kRadius, 0.05), 0.5, 0.0), "ball", Vector3(-0.07, 0.055, 0.0));
  Objects objects(of(bar_first ? std::vector<Body>{bar, ball} : std::vector<Body>{ball, bar}), 0.005);
  double deepest = 0.0;
  objects.run(0.1, [&] {
    const Pose& pose = objects.state(bar_first ? 0 : 1).pose;
    const Vector3 local = pose.inverse() * objects.state(bar_first ? 1 : 0).pose.position;
    const Vector3 nearest = local.cwiseMax(-half).cwiseMin(half);
    deepest = std::max(deepest, kRadius - (local - nearest).norm());
  });
  EXPECT_GT(objects.twist(bar_first ? 1 : 0).linear.norm(), 1.0);
  return deepest;
}

TEST(ObjectsTouch, what_turns_fast_meets_what_is_in_its_way_at_its_time_whichever_is_listed_first) {
  // Of 13 mm a step; a touch is found to a micrometre.
  EXPECT_LT(deepest_of_a_blow_by_turning(true), 1e-4);
  EXPECT_LT(deepest_of_a_blow_by_turning(false), 1e-4);
}

TEST(ObjectsTouch, the_order_in_which_objects_are_listed_does_not_matter) {
  Scene scene = cloud();
  Scene reversed = scene;
  std::reverse(reversed.bodies.begin(), reversed.bodies.end());
  Objects one(scene), other(reversed);
  one.run(0.3);
  other.run(0.3);
  const std::size_t count = scene.bodies.size();
  for (std::size_t b = 0; b < count; ++b)
    EXPECT_NEAR((one.state(b).pose.position - other.state(count - 1 - b).pose.position).norm(), 0.0, 1e-10)
        << b;
}

/// Angular deceleration of a body that spins about z on a floor at 1 g [rad/s^2].
double braking(Body body, double height, double step) {
  Scene scene;
  Body floor = box_body(Vector3(2.0, 2.0, 0.1), 1.0);
  floor.name = "floor";
  floor.fixed = true;
  floor.start.position = Vector3(0, 0, -0.05);
  body.start.position = Vector3(0, 0, height);
  scene.bodies = {floor, body};
  scene.gravity = Vector3(0, 0, -kGravity);
  for (Body& one : scene.bodies) one.material.dynamic_friction = one.material.static_friction = 0.5;
  scene.bodies[1].start_twist.angular = Vector3(0, 0, 40.0);
  Objects objects(scene, step);
  objects.run(0.032);  // settles on its springs
  const double before = objects.twist(1).angular.z();
  objects.run(0.064);
  return (before - objects.twist(1).angular.z()) / 0.064;
}

// A face that presses evenly brakes with mu m g times the mean distance of its places from the middle: of a
// square of side a 0.3826 a, of a disc 2/3 of the radius. Corners alone brake 1.85 times as fast. Within a
// thousandth; in steps of 8 ms the body turns by 0.3 rad in a step, which takes 0.7 % of the friction.
TEST(ObjectsTouch, a_body_that_spins_on_a_floor_is_braked_by_its_whole_face) {
  const double side = 0.05, radius = 0.03, mass = 0.1;
  const double mean_of_square = side * (std::sqrt(2.0) + std::asinh(1.0)) / 6.0;
  Body can = box_body(Vector3(2 * radius, 2 * radius, 0.05), mass);
  can.shapes = {{Cylinder{radius, 0.025}, {}}};
  can.inertia = mass * Vector3(radius * radius / 4 + 0.05 * 0.05 / 12, radius * radius / 4 + 0.05 * 0.05 / 12,
                               radius * radius / 2)
                           .asDiagonal();
  complete(can);
  for (const double step : {0.00025, 0.001, 0.008}) {
    SCOPED_TRACE(step);
    const double tolerance = step < 0.002 ? 1e-3 : 1e-2;
    const double of_square = 0.5 * kGravity * mean_of_square / (side * side / 6.0);
    EXPECT_NEAR(braking(box_body(Vector3::Constant(side), mass), side / 2, step), of_square,
                tolerance * of_square);
    const double of_disc = 0.5 * kGravity * (2.0 / 3.0 * radius) / (radius * radius / 2.0);
    EXPECT_NEAR(braking(can, 0.025, step), of_disc, tolerance * of_disc);
  }
}

}  // namespace
}  // namespace mrhi
