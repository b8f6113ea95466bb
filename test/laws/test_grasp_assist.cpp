#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <optional>

#include "mr_hand_interaction/response/grip.h"
#include "mr_hand_interaction/scene/scene.h"
#include "support/reaching_hand.h"

namespace mrhi {
namespace {

struct Reach {
  double deep = 0.012, ahead = 0.0;
  bool assist = true, opens = false;
  double friction = 0.8, gravity = 0.0;
};

/// Where the cube ends up against the hand, which closes in 0.2 s, carries it by 10 cm and may open again.
struct Outcome {
  double off = 0.0, speed = 0.0, strongest = 0.0;
  std::size_t grips = 0;
  bool borne = false;  // by a grip
};

Outcome outcome_of(const Reach& reach) {
  Configuration configuration = testing::implicit_configuration();
  configuration.contact.grasp_assist = reach.assist;
  configuration.contact.hand = HandStrength::of_a_person();
  Body cube = testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 0.1);
  cube.material.static_friction = cube.material.dynamic_friction = reach.friction;
  Simulation simulation(testing::scene_of(cube), configuration);
  Outcome outcome;
  Vector3 shift = Vector3::Zero();
  testing::play(
      simulation, 0.0, 2.0, 120.0,
      [&](double t) {
        shift = 0.1 * testing::smooth(t - 0.5, 0.5) * Vector3::UnitY();
        const double opened = reach.opens ? std::min(std::max(0.0, t - 1.5) / 0.2, 1.0) : 0.0;
        return testing::reaching(std::min(t / 0.2, 1.0) - opened, reach.deep, reach.ahead, shift);
      },
      [&](const Simulation& s) {
        outcome.grips = std::max(outcome.grips, s.state().grips.size());
        for (const Grip& grip : s.state().grips) outcome.borne = outcome.borne || grip.active;
        for (const Contact& contact : s.result().contacts)
          outcome.strongest = std::max(outcome.strongest, contact.force.norm());
      });
  outcome.off = (simulation.state().bodies[0].pose.position - shift).norm();
  outcome.speed = testing::object_twist(simulation).linear.norm();
  return outcome;
}

TEST(GraspAssist, holds_what_the_hand_closes_through) {
  for (const double ahead : {0.0, 0.01, -0.01}) {
    const Outcome outcome = outcome_of({0.012, ahead});
    EXPECT_EQ(outcome.grips, 1u) << ahead;
    EXPECT_LT(outcome.off, 0.012) << ahead;
    EXPECT_LT(outcome.strongest, 1.1 * HandStrength::of_a_person().finger) << ahead;
  }
}

// A ball of 30 mm at a camera's 30 Hz: open in one frame, closed 1 cm beyond its surface in the next.
TEST(GraspAssist, holds_a_ball_that_fingers_dive_into_within_a_frame) {
  for (const double rate : {30.0, 60.0, 120.0}) {
    Body ball = testing::box_body(Vector3::Constant(0.03), 0.05);
    ball.shapes[0].shape = Sphere{0.015};
    Simulation simulation(testing::scene_of(ball), Configuration());
    testing::play(
        simulation, 0.0, 0.8, rate,
        [&](double t) {
          return testing::moved(
              testing::reaching(testing::smooth(t - 0.1, 0.05), 0.017, 0.0, Vector3(0, 0.002, 0)),
              {0.1 * testing::smooth(t - 0.3, 0.4) * Vector3::UnitY(), {1, 0, 0, 0}});
        },
        [](const Simulation&) {});
    EXPECT_LT((simulation.state().bodies[0].pose.position - 0.1 * Vector3::UnitY()).norm(), 0.015) << rate;
  }
}

// Both hands hold a bar. The first one, with one finger more, pulls it off the second one's index.
TEST(GraspAssist, a_hand_without_one_of_its_sides_does_not_pull_at_what_the_other_hand_holds) {
  constexpr double kDeep = 0.006, kPulled = 0.03, kAside = 0.015;
  Simulation simulation(
      testing::scene_of(testing::stiff_box(Vector3(2.0 * testing::kReachedHalf, 0.1, 0.1), 0.3)),
      Configuration());
  const auto hands_at = [=](double t) {
    const double closed = std::min(t / 0.2, 1.0),
                 in =
                     testing::kFingersAway - closed * (testing::kFingersAway - testing::kReachedHalf + kDeep);
    Hand first = testing::reaching(closed, kDeep, 0.0);
    testing::add_fingertip(first, capsule_index(2, 3), Vector3(in, 0, -kAside), Vector3::UnitX(), 1.2);
    Pose pulled;
    pulled.position.x() = -kPulled * testing::smooth(t - 0.6, 0.2);
    Hand second = testing::reaching(closed, kDeep, 0.0, Vector3(0, 0.02, 0));
    second.id = 2;
    second.side = Side::left;
    return std::vector<Hand>{testing::moved(first, pulled), second};
  };
  std::array<int, 2> supported{};
  for (int i = 0; i <= 160; ++i) {
    const double t = i / 120.0;
    ASSERT_EQ(simulation.advance({testing::at(t), hands_at(t)}), Rejection::none);
    for (const GraspSupport& support : simulation.result().assists)
      if (t > 0.85) ++supported[support.hand];
  }
  EXPECT_GT(supported[0], 0);
  EXPECT_EQ(supported[1], 0);
}

// Two fingers of a person's strength, friction 0.3: contact supports up to 18 N, and grasp assist as much
// again.
TEST(GraspAssist, supports_at_most_twice_the_friction_of_the_fingers) {
  for (const double mass : {1.0, 6.0}) {
    Configuration configuration = testing::implicit_configuration();
    configuration.contact.grasp_assist = true;
    configuration.contact.hand = HandStrength::of_a_person();
    configuration.gravity = Vector3(0, 0, -9.81);
    Body cube = testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), mass);
    cube.material.static_friction = cube.material.dynamic_friction = 0.3;
    Body floor = testing::stiff_box(Vector3(0.2, 0.2, 0.01), 1.0);
    floor.fixed = true;
    floor.start.position.z() = -testing::kReachedHalf - 0.005;
    Scene scene = testing::scene_of(cube);
    scene.bodies.push_back(floor);
    complete(scene.bodies.back());
    Simulation simulation(scene, configuration);
    testing::play(simulation, 0.0, 1.5, 120.0, [&](double t) {
      return testing::reaching(std::min(t / 0.2, 1.0), 0.012, 0.0,
                               0.1 * testing::smooth(t - 0.5, 0.5) * Vector3::UnitZ());
    });
    const double lifted = simulation.state().bodies[0].pose.position.z();
    if (mass < 2.0) {
      EXPECT_GT(lifted, 0.09);
    } else {
      EXPECT_LT(lifted, 0.05);
    }
  }
}

/// Two plates with a hinge between them, closed, as thick together as the cube: the thumb reaches for the
/// base and the index for the lid.
Scene book(double friction) {
  constexpr double kEdge = 0.03;  // half of it [m]
  Scene scene;
  for (const double side : {-1.0, 1.0}) {
    Body plate = testing::stiff_box(Vector3(testing::kReachedHalf, 2.0 * kEdge, 2.0 * kEdge), 0.22);
    plate.name = side < 0.0 ? "base" : "lid";
    plate.start.position.x() = side * 0.5 * testing::kReachedHalf;
    plate.material.static_friction = plate.material.dynamic_friction = friction;
    scene.bodies.push_back(plate);
  }
  Joint hinge;
  hinge.name = "hinge";
  hinge.parent = 0, hinge.child = 1;
  hinge.axis = -Vector3::UnitZ();
  hinge.in_parent.position = Vector3(0.5 * testing::kReachedHalf, -kEdge, 0);
  hinge.in_child.position = Vector3(-0.5 * testing::kReachedHalf, -kEdge, 0);
  hinge.lower = 0.0, hinge.upper = 1.5;
  scene.joints.push_back(hinge);
  return scene;
}

// The hand accelerates by 1 g. Friction of both fingers carries 3.2 N of the 4.3 N that 0.44 kg need.
TEST(GraspAssist, takes_a_linkage_as_a_whole) {
  std::array<double, 2> off{};
  for (const bool assist : {true, false}) {
    Configuration configuration;
    configuration.contact.grasp_assist = assist;
    Simulation simulation(book(0.1), configuration);
    bool active = false;
    std::size_t grips = 0;
    Vector3 shift = Vector3::Zero();
    testing::play(
        simulation, 0.0, 0.9, 120.0,
        [&](double t) {
          const double moved = std::max(0.0, t - 0.5);
          shift = 0.5 * 9.81 * moved * moved * Vector3::UnitZ();
          return testing::reaching(testing::smooth(t, 0.3), 0.012, 0.0, shift);
        },
        [&](const Simulation& s) {
          grips = std::max(grips, s.state().grips.size());
          for (const Grip& grip : s.state().grips) active = active || grip.active;
        });
    off[assist ? 0 : 1] = std::abs(simulation.state().bodies[0].pose.position.z() - shift.z());
    EXPECT_EQ(grips, assist ? 1u : 0u);
    EXPECT_EQ(active, assist);
    EXPECT_LT(simulation.state().joints[0].position, 0.05) << "it stays shut";
  }
  EXPECT_LT(off[0], 0.025) << "it stays between the fingers";
  EXPECT_GT(off[1], 0.05);
}

TEST(GraspAssist, without_it_the_first_finger_decides) {
  EXPECT_GT(outcome_of({0.012, 0.01, false}).off, outcome_of({0.012, 0.01, true}).off);
}

// Fingers that do not slip need no help: what a scripted hand grasps is held as ever.
TEST(GraspAssist, bears_nothing_that_contact_holds) {
  Configuration configuration = testing::implicit_configuration();
  configuration.contact.grasp_assist = true;
  Simulation simulation(
      testing::scene_of(testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 0.1)),
      configuration);
  bool taken = false;
  testing::play(
      simulation, 0.0, 1.5, 120.0,
      [&](double t) {
        return testing::reaching(1.0 - testing::smooth(0.2 - t, 0.2), 0.006, 0.0,
                                 0.1 * testing::smooth(t - 0.8, 0.5) * Vector3::UnitY());
      },
      [&](const Simulation& s) {
        for (const Grip& grip : s.state().grips) {
          taken = true;
          EXPECT_FALSE(grip.active);
        }
      });
  EXPECT_TRUE(taken);
}

// A hand at rest, closed round a cube off its middle: thumb and index hold it, so assist has nothing to add.
// In place of 23 N that opposed the nearer finger, what is left is a tenth.
TEST(GraspAssist, a_hand_at_rest_presses_what_it_holds_off_its_middle_and_assist_does_not_oppose_it) {
  Configuration configuration;  // as shipped
  configuration.gravity = Vector3::Zero();
  Simulation simulation(
      testing::scene_of(testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 0.1)),
      configuration);
  double force = 0.0;
  testing::play(
      simulation, 0.0, 2.0, 60.0,
      [&](double t) { return testing::reaching(testing::smooth(t, 0.3), 0.004, 0.012); },
      [&](const Simulation& s) {
        force = 0.0;
        for (const Grip& grip : s.state().grips)
          force = std::max(force, grip.active ? grip.force.norm() : 0.0);
      });
  EXPECT_LT(simulation.state().bodies[0].pose.position.norm(), 0.02) << "held";
  EXPECT_LT(force, 2.0);
}

// Every step, the forces and impacts of the contacts, and grasp assist's force beside them, are what changes
// the body's momentum.
TEST(GraspAssist, its_wrench_and_the_contacts_are_all_that_acts_on_the_body) {
  // 1 mN for a frame: the forces are those of the last iterate, the momenta of the next.
  constexpr double kRate = 120.0, kSolved = 2e-5;  // [N s]
  // A twelfth of what the assist's torque does in a frame: arms are those of the frame's end.
  constexpr double kTurned = 4e-5;  // [N m s]
  Configuration configuration = testing::implicit_configuration();
  configuration.step = 1.0 / 119.0;  // a frame is a step
  configuration.contact.hand = HandStrength::of_a_person();
  Body heavy = testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 3.0);
  heavy.material.static_friction = heavy.material.dynamic_friction = 0.1;  // slips
  Simulation simulation(testing::scene_of(heavy), configuration);
  Vector3 before = Vector3::Zero(), turned = Vector3::Zero(), centre = Vector3::Zero();
  Nanoseconds last = 0;
  int borne = 0;
  testing::play(
      simulation, 0.0, 1.5, kRate,
      [&](double t) {
        return testing::reaching(std::min(t / 0.2, 1.0), 0.012, 0.01,
                                 0.1 * testing::smooth(t - 0.5, 0.5) * Vector3::UnitY());
      },
      [&](const Simulation& s) {
        const BodyState& body = s.state().bodies[0];
        const Vector3 now = body.linear_momentum;
        Vector3 given = Vector3::Zero(), turn = Vector3::Zero();
        const double frame = to_seconds(s.state().time - last);
        for (const Contact& contact : s.result().contacts) {
          const Vector3 impulse = frame * contact.force + contact.impulse;
          given += impulse,
              turn += (contact.point - centre).cross(impulse) + frame * contact.torque * contact.normal;
        }
        for (const GraspSupport& assist : s.result().assists)
          given += frame * assist.force, turn += frame * assist.torque;
        if (last != 0 && s.result().contacts.size() > 1) {  // of a touch that ends nothing is told
          EXPECT_LT((now - before - given).norm(), kSolved) << to_seconds(s.state().time);
          EXPECT_LT((body.angular_momentum - turned - turn).norm(), kTurned) << to_seconds(s.state().time);
        }
        for (const Grip& grip : s.state().grips) borne += grip.active;
        before = now, turned = body.angular_momentum, centre = body.pose.position, last = s.state().time;
      });
  EXPECT_GT(borne, 50);
}

/// Thumb and index in a palm's frame, moved by `way` there.
Hand pinching(const Pose& palm, const Pose& way) {
  Hand hand;
  hand.palm = palm;
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY();
  const Pose in_world = palm * way;
  hand.capsules[capsule_index(0, 3)] = {in_world * Vector3(0.05 * x - 0.02 * y),
                                        in_world * Vector3(0.07 * x - 0.015 * y), 0.008};
  hand.capsules[capsule_index(1, 3)] = {in_world * Vector3(0.05 * x + 0.02 * y),
                                        in_world * Vector3(0.07 * x + 0.015 * y), 0.008};
  return hand;
}

TEST(GraspAssist, what_a_grip_bears_goes_with_the_pads_and_turns_a_little_with_the_palm) {
  const Pose palm{{0.3, -0.2, 0.1}, Quaternion(Eigen::AngleAxisd(0.7, Vector3(1, 2, 2).normalized()))};
  Grip grip;
  grip.fingers = 1 << 1;
  grip.pads = distal_ends(pinching(palm, {}));
  const Pose nowhere = moved_in_palm(grip, pinching(palm, {}));
  EXPECT_LT(nowhere.position.norm(), 1e-15);
  EXPECT_LT(nowhere.orientation.vec().norm(), 1e-15);

  // About the pads' own middle, by which they roll a pen.
  constexpr double kTurn = 0.3;
  const Vector3 middle(0.06, 0.0, 0.0);
  const Quaternion turn(Eigen::AngleAxisd(kTurn, Vector3::UnitZ()));
  const Pose way{middle - turn * middle + Vector3(0, 0, 0.01), turn};
  const Pose moved = moved_in_palm(grip, pinching(palm, way));
  EXPECT_LT((moved * middle - (middle + Vector3(0, 0, 0.01))).norm(), 1e-12);
  // In the plane of the pads their spread, 1/4 (4 (1 cm)^2 + 2 (2 cm)^2 + 2 (1.5 cm)^2), stands against
  // twice (8 mm)^2: the angle is that of the sum of both turns.
  const double pads = 0.01 * 0.01 + 0.5 * (0.02 * 0.02 + 0.015 * 0.015), still = 2.0 * 0.008 * 0.008;
  const double expected = std::atan2(pads * std::sin(kTurn), pads * std::cos(kTurn) + still);
  EXPECT_NEAR(Eigen::AngleAxisd(moved.orientation).angle(), expected, 1e-12);
  EXPECT_GT(expected, 0.7 * kTurn);
}

// As deep as a pulp gives, contact holds by itself.
TEST(GraspAssist, takes_nothing_that_contact_holds) {
  const Outcome outcome = outcome_of({0.002, 0.0});
  EXPECT_EQ(outcome.grips, 0u);
  EXPECT_LT(outcome.off, 0.002);
}

/// Thumb and three fingers that close round a bar, with their middle phalanges, which slip along its edges.
Hand closing_round_bar(double gap) {
  constexpr double kRadius = 0.008, kPad = 0.0125;
  Hand hand = testing::empty_hand();
  const auto add = [&](int finger, double side, double z) {
    const double x = side * (gap + kRadius);
    const Vector3 joint(x, kPad, z);
    testing::add_finger(hand, capsule_index(finger, 3), joint, Vector3(x, -kPad, z), kRadius);
    testing::add_finger(hand, capsule_index(finger, 2), Vector3(x + side * 0.008, 0.036, z), joint, kRadius);
  };
  add(0, -1.0, 0.0);
  for (int finger = 1; finger <= 3; ++finger) add(finger, 1.0, 0.02 * (finger - 2));
  return hand;
}

// 4 mm deep on both sides, without noise.
TEST(GraspAssist, adds_nothing_to_a_pinch_of_a_thin_body_of_which_a_middle_phalanx_alone_slips) {
  for (const double thickness : {0.01, 0.016, 0.02}) {
    for (const double rate : {60.0, 120.0, 240.0}) {
      Body bar = testing::stiff_box(Vector3(thickness, thickness, 0.12), 0.05);
      Simulation simulation(testing::scene_of(bar), Configuration());
      std::size_t assists = 0;
      testing::play(
          simulation, 0.0, 1.0, rate,
          [&](double t) {
            return closing_round_bar(0.5 * thickness + 0.012 - 0.016 * testing::smooth(t - 0.1, 0.15));
          },
          [&](const Simulation& s) { assists += s.result().assists.size(); });
      EXPECT_EQ(assists, 0u) << thickness << " m, " << rate << " Hz";
    }
  }
}

TEST(GraspAssist, lets_go_without_a_kick_as_the_hand_opens) {
  Reach reach;
  reach.opens = true;
  EXPECT_LT(outcome_of(reach).speed, 0.01);
}

// The hand closes beside the cube, or passes it without closing.
TEST(GraspAssist, takes_nothing_that_is_not_between_the_fingers) {
  Configuration configuration = testing::implicit_configuration();
  configuration.contact.grasp_assist = true;
  const Scene scene =
      testing::scene_of(testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 0.1));
  for (const bool closes : {true, false}) {
    Simulation simulation(scene, configuration);
    testing::play(
        simulation, 0.0, 1.0, 120.0,
        [&](double t) {
          const Vector3 way = closes ? Vector3(0, 0.06, 0) : Vector3(0, 0.2 * (t - 0.5), 0.06);
          return testing::reaching(closes ? std::min(t / 0.2, 1.0) : 0.0, 0.012, 0.0, way);
        },
        [&](const Simulation& s) { EXPECT_TRUE(s.state().grips.empty()); });
  }
}

// What the grip could bear is bounded: a body as heavy as a hand cannot hold stays where it is.
TEST(GraspAssist, drags_nothing_that_friction_could_not_hold) {
  Configuration configuration = testing::implicit_configuration();
  configuration.contact.grasp_assist = true;
  configuration.contact.hand = HandStrength::of_a_person();
  Simulation simulation(
      testing::scene_of(testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 1000.0)),
      configuration);
  testing::play(simulation, 0.0, 1.0, 120.0, [&](double t) {
    return testing::reaching(std::min(t / 0.2, 1.0), 0.012, 0.0,
                             Vector3(0, 0.1 * testing::smooth(t - 0.3, 0.3), 0));
  });
  EXPECT_LT(testing::object_twist(simulation).linear.norm(),
            2.0 * 0.8 * HandStrength::of_a_person().finger / 1000.0 + 0.02);
}

/// Most grips at a time, while the hand closes as `hand` says.
struct Taken {
  std::size_t grips = 0;
};

template <typename HandAt>
Taken taken_from(const Scene& scene, HandAt&& hand) {
  Configuration configuration = testing::implicit_configuration();
  configuration.contact.hand = HandStrength::of_a_person();
  Simulation simulation(scene, configuration);
  Taken taken;
  testing::play(simulation, 0.0, 0.5, 120.0, hand,
                [&](const Simulation& s) { taken.grips = std::max(taken.grips, s.state().grips.size()); });
  return taken;
}

Body fixture(const Vector3& size, const Vector3& position) {
  Body block = testing::stiff_box(size, 1.0);
  block.name = "fixture" + std::to_string(position.y());
  block.fixed = true;
  block.start.position = position;
  return block;
}

// Another finger of the hand is in a wall: the hand is shown before it, where it does not close on the cube.
TEST(GraspAssist, takes_nothing_while_the_hand_is_deep_in_a_fixture) {
  constexpr double kWall = 0.1;  // y of its face [m]
  Scene scene = testing::scene_of(testing::stiff_box(Vector3::Constant(2.0 * testing::kReachedHalf), 0.1));
  scene.bodies.push_back(fixture(Vector3(0.2, 0.1, 0.2), Vector3(0, kWall + 0.05, 0)));
  for (const double deep : {0.005, 0.025}) {
    const Taken taken = taken_from(scene, [&](double t) {
      Hand hand = testing::reaching(std::min(t / 0.2, 1.0), 0.012, 0.0);
      const double in = kWall + std::min(t / 0.05, 1.0) * (deep + 0.01) - 0.01;
      testing::add_fingertip(hand, capsule_index(4, 3), Vector3(0, in, 0), -Vector3::UnitY(), 1.2);
      return hand;
    });
    EXPECT_EQ(taken.grips, deep > 0.015 ? 0u : 1u) << deep;
  }
}

TEST(GraspAssist, same_input_same_bits) {
  const Outcome first = outcome_of({}), second = outcome_of({});
  EXPECT_EQ(first.off, second.off);
  EXPECT_EQ(first.speed, second.speed);
}

}  // namespace
}  // namespace mrhi
