#include "operators_at_work.h"
#include "support/fixtures.h"

namespace mrhi {
namespace {

using Phase = SimulatedOperator::Phase;

constexpr double kFrame = 1.0 / 115.0;
const Vector3 kPlace(0.0, 0.1, 0.3);

Sight at_rest(const Body& body) {
  return {body.start, {}, kPlace};
}

TEST(Operator, moves_only_once_the_reaction_time_is_over) {
  const Body cube = testing::shipped_body("cube");
  OperatorSkill skill;
  skill.reaction_time = 0.3;
  SimulatedOperator person(skill, cube, 1);
  const Vector3 rest = person.move(0.0, at_rest(cube)).wrist.position;
  double time = 0.0;
  while (person.phase() == Phase::watching) {
    time += kFrame;
    const Vector3 wrist = person.move(time, at_rest(cube)).wrist.position;
    if (person.phase() == Phase::watching) {
      EXPECT_EQ(wrist, rest);
    }
    ASSERT_LT(time, 1.0);
  }
  EXPECT_NEAR(time, 0.3, kFrame);
}

// Fitts' law says how long; the way ends at the grasp, at rest.
TEST(Operator, reach_ends_where_and_when_it_should) {
  const Body cube = testing::shipped_body("cube");
  const OperatorSkill skill;
  SimulatedOperator person(skill, cube, 1);
  const Vector3 rest = person.move(0.0, at_rest(cube)).wrist.position;
  const Vector3 held = cube.start.position + shipped_grasp("cube").wrist.position;
  const double duration =
      skill.movement_start + skill.movement_per_bit * std::log2((held - rest).norm() / 0.01 + 1.0);
  double time = 0.0, began = 0.0;
  Vector3 wrist = rest, wrist_before = rest;
  while (person.phase() == Phase::watching || person.phase() == Phase::reaching) {
    time += kFrame;
    wrist_before = wrist;
    wrist = person.move(time, at_rest(cube)).wrist.position;
    if (began == 0.0 && person.phase() == Phase::reaching) began = time;
    ASSERT_LT(time, 3.0);
  }
  EXPECT_NEAR(time - began, duration, 2.0 * kFrame);
  // The frame before is at most two frames before the end, where minimum jerk has 10 (t/T)^3 of the way left.
  EXPECT_LT((wrist_before - held).norm(), 10.0 * std::pow(2.0 * kFrame / duration, 3) * (held - rest).norm());
}

// Of one that occurs as the hand is under way: people correct within 100 ms (Paulignan et al. 1991).
TEST(Operator, learns_of_a_leap_of_the_object_100_ms_later) {
  const Body cube = testing::shipped_body("cube");
  const OperatorSkill skill;
  SimulatedOperator surprised(skill, cube, 1), undisturbed(skill, cube, 1);
  const double leap = 0.5;
  double differed = 0.0;
  for (double time = 0.0; differed == 0.0; time += kFrame) {
    ASSERT_LT(time, 1.5);
    Sight sight = at_rest(cube);
    const Vector3 expected = undisturbed.move(time, sight).wrist.position;
    if (time >= leap) sight.object.position.x() += 0.1;
    if (surprised.move(time, sight).wrist.position != expected) differed = time;
  }
  // What is planned in one frame shows in the same.
  EXPECT_NEAR(differed - leap, 0.1, 2.0 * kFrame);
  EXPECT_GE(differed - leap, 0.1 - 1e-9);
}

TEST(Operator, same_seed_same_bits_and_another_seed_others) {
  const Body cube = testing::shipped_body("cube");
  const OperatorSkill skill = beginner_skill();
  SimulatedOperator one(skill, cube, 7), same(skill, cube, 7), other(skill, cube, 8);
  bool differs = false;
  for (double time = 0.0; time < 2.0; time += kFrame) {
    const HandPlace a = one.move(time, at_rest(cube)), b = same.move(time, at_rest(cube)),
                    c = other.move(time, at_rest(cube));
    EXPECT_EQ(a.wrist.position, b.wrist.position);
    EXPECT_EQ(a.posture, b.posture);
    differs |= a.wrist.position != c.wrist.position;
  }
  EXPECT_TRUE(differs);
}

/// Takes a cube that stays where it is, and lets it go at once.
struct LetsGo {
  const Body cube = testing::shipped_body("cube");
  SimulatedOperator person{OperatorSkill(), cube, 1};
  Sight sight = at_rest(cube);
  double time = 0.0;

  LetsGo() {
    sight.place = cube.start.position;
    goes_on_until(Phase::carrying);
    sight.place.reset();
  }

  /// The hand's orientation then.
  Quaternion goes_on_until(Phase phase) {
    HandPlace hand;
    do {
      hand = person.move(time += kFrame, sight);
    } while (person.phase() != phase && time < 30.0);
    EXPECT_EQ(person.phase(), phase);
    return hand.wrist.orientation;
  }
};

TEST(Operator, turns_its_hand_over_when_what_it_has_let_go_clings_to_it) {
  LetsGo run;
  const Quaternion let_go = run.goes_on_until(Phase::done);
  for (int i = 0; i < 100; ++i) run.person.move(run.time += kFrame, run.sight);
  EXPECT_EQ(run.person.phase(), Phase::done);
  run.sight.held = true;
  run.goes_on_until(Phase::releasing);
  EXPECT_NEAR(let_go.angularDistance(run.goes_on_until(Phase::done)), 2.0 * M_PI / 3.0, 1e-6);
}

TEST(Operator, takes_it_again_when_it_is_wanted_somewhere_once_it_is_done) {
  LetsGo run;
  run.goes_on_until(Phase::done);
  run.sight.place = kPlace;
  run.goes_on_until(Phase::reaching);
}

TEST(Operator, refuses_an_object_that_no_hand_closes_on_and_names_it) {
  Body body = testing::box_body(Vector3::Constant(0.3), 1.0);
  body.name = "teapot";
  try {
    SimulatedOperator person(OperatorSkill{}, body, 1);
    FAIL() << "took it";
  } catch (const std::invalid_argument& error) {
    EXPECT_NE(std::string(error.what()).find("teapot"), std::string::npos);
    EXPECT_NE(std::string(error.what()).find("; allowed: "), std::string::npos);
  }
}

TEST(OperatorSkill, group_is_beginner_or_veteran) {
  EXPECT_THROW(draw_skill("expert", 1), std::invalid_argument);
  EXPECT_EQ(draw_skill("veteran", 3).reaction_time, draw_skill("veteran", 3).reaction_time);
  EXPECT_NE(draw_skill("veteran", 3).reaction_time, draw_skill("veteran", 4).reaction_time);
}

TEST(BoxSymmetries, are_those_of_the_outline) {
  EXPECT_EQ(box_symmetries(testing::shipped_body("cube")).size(), 24u);
  EXPECT_EQ(box_symmetries(testing::shipped_body("long_cuboid")).size(), 8u);
  EXPECT_EQ(box_symmetries(testing::shipped_body("flat_cuboid")).size(), 4u);
  EXPECT_EQ(box_symmetries(testing::shipped_body("ball")).size(), 1u);
}

}  // namespace
}  // namespace mrhi
