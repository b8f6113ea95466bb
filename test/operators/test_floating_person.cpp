// A simulated operator who floats, at the training tasks for 0 g.

#include "operators_at_work.h"
#include "synthetic/floating_person.h"

namespace mrhi {
namespace {

Task floating_task(const std::string& name) {
  return load_task("config/tasks/" + name + ".yaml");
}

TrialMeasures done(const std::string& name) {
  const TrialRow row = testing::play(floating_task(name), OperatorSkill{}, 1, 0.0);
  EXPECT_EQ(row.result, TrialResult::completed) << name;
  return row.measures;
}

/// Bounds beside those of the tasks' goals: a person pulls, glides at 0.15 m/s and stops within a minute.
TEST(FloatingPerson, pulls_along_the_rail_and_stops_at_the_mark) {
  const TrialMeasures measures = done("rail");
  EXPECT_GE(measures.touches, 4) << "each hand takes the rail to pull, and again to stop";
  ASSERT_TRUE(measures.arrival_speed && measures.misplacement && measures.operator_speed);
  EXPECT_GT(*measures.arrival_speed, 0.1) << "people go 0.1 to 0.3 m/s along a rail";
  EXPECT_LT(*measures.arrival_speed, 0.3);
  EXPECT_LE(*measures.misplacement, 0.15);
  EXPECT_LT(*measures.operator_speed, 0.03);
  EXPECT_LT(measures.completion_time, 60.0);
}

TEST(FloatingPerson, docks_the_crate_softly) {
  const TrialMeasures measures = done("dock");
  ASSERT_TRUE(measures.arrival_speed && measures.misplacement && measures.misalignment);
  EXPECT_LT(*measures.arrival_speed, 0.1);
  EXPECT_LE(*measures.misplacement, 0.03);
  EXPECT_LT(*measures.misalignment, 5.0 * M_PI / 180.0);
  EXPECT_EQ(measures.drops, 0);
}

TEST(FloatingPerson, throws_the_bag_into_the_net_and_stops_the_spin_at_a_rail) {
  const TrialMeasures measures = done("throw");
  ASSERT_TRUE(measures.arrival_speed && measures.operator_spin);
  EXPECT_NEAR(*measures.arrival_speed, 0.8, 0.1) << "the speed that is meant";
  EXPECT_LT(*measures.operator_spin, 0.05);
  EXPECT_GE(measures.touches, 3) << "the bag, and the rail with both hands";
}

TEST(FloatingPerson, opens_the_hatch_with_a_hand_on_a_rail) {
  const TrialMeasures measures = done("hatch_0g");
  EXPECT_LT(measures.completion_time, 40.0);
  ASSERT_TRUE(measures.operator_speed && measures.operator_spin);
  EXPECT_LT(*measures.operator_speed, 0.03);
  EXPECT_LT(*measures.operator_spin, 0.1);
}

/// A veteran with tremor, errors of aim and a tracker's noise.
TrialRow by_veteran(const std::string& name, std::uint64_t person, bool holds_rail = true) {
  OperatorSkill skill = draw_skill("veteran", 8000 + person);
  skill.holds_rail = holds_rail;
  return testing::play(floating_task(name), skill, person, 1.0);
}

TEST(FloatingPerson, veterans_do_all_tasks) {
  constexpr std::uint64_t kPersons = 4;
  for (const char* const name : {"rail", "dock", "throw", "hatch_0g"}) {
    std::uint64_t completed = 0;
    for (std::uint64_t person = 1; person <= kPersons; ++person)
      completed += by_veteran(name, person).result == TrialResult::completed;
    EXPECT_GE(completed, kPersons - 1) << name;
  }
}

/// Latches and hatch push them away, so they push shortly, and come back along a rail where they drift.
TEST(FloatingPerson, veterans_open_the_hatch_with_both_hands_free_and_take_longer) {
  constexpr std::uint64_t kPersons = 6;
  double times = 0.0, completed = 0.0;
  for (std::uint64_t person = 1; person <= kPersons; ++person) {
    const TrialRow row = by_veteran("hatch_0g", person, false);
    if (row.result != TrialResult::completed) continue;
    ++completed, times += row.measures.completion_time;
    EXPECT_GE(row.measures.touches, 4) << "two latches, the handle, a rail or a second try";
  }
  EXPECT_GE(completed, kPersons - 2) << "26 of 30 veterans do: scripts/figures --page afloat";
  EXPECT_GT(times / completed, 25.0) << "with a hand on a rail it takes 22 s";
}

TEST(FloatingPerson, same_seed_same_bits) {
  const Task task = floating_task("throw");
  const auto time = [&](std::uint64_t seed) {
    return testing::play(task, draw_skill("veteran", 8001), seed, 1.0).measures.arrival_speed.value_or(0.0);
  };
  EXPECT_EQ(time(5), time(5));
  EXPECT_NE(time(5), time(6));
}

TEST(FloatingPerson, is_refused_without_an_operator_or_a_rail) {
  const Task task = floating_task("rail");
  OperatorStage stage;
  stage.scene_folders = {"config/scenes"};
  const auto expect_refusal = [&](const Scene& scene, const char* word) {
    try {
      make_person({}, task, scene.bodies.front(), 1, scene);
      FAIL() << "no error: " << word;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  };
  Scene scene = operator_scene(task, task.objects.front(), stage);
  remove_body(static_cast<std::size_t>(*find_body(scene, "rail")), scene);
  remove_body(static_cast<std::size_t>(*find_body(scene, "upper_rail")), scene);
  expect_refusal(scene, "no rail");
  scene.operators.clear();
  expect_refusal(scene, "no operator");
}

TEST(Rails, are_fixtures_that_are_one_cylinder_at_most_6_cm_thick_and_at_least_30_cm_long) {
  const auto rail = [](double radius, double length, bool fixed) {
    Scene scene;
    Body body;
    body.name = "rail", body.fixed = fixed;
    body.shapes.push_back({Cylinder{radius, 0.5 * length}, Pose{}});
    scene.bodies = {body};
    return scene;
  };
  EXPECT_EQ(rails_of(rail(0.0299, 0.301, true)).size(), 1u);
  EXPECT_THROW(rails_of(rail(0.0301, 0.301, true)), std::invalid_argument);
  EXPECT_THROW(rails_of(rail(0.0299, 0.299, true)), std::invalid_argument);
  EXPECT_THROW(rails_of(rail(0.0299, 0.301, false)), std::invalid_argument);
}

/// Each finger but the thumb touches with at least two bones, none deeper than the compliance of a soft pad.
TEST(PowerGrip, closes_all_fingers_round_rails_of_2_to_5_cm) {
  for (const double radius : {0.01, 0.016, 0.025}) {
    const PowerGrip grip(radius);
    const auto depths = [&](const HandPosture& posture, int finger) {
      std::vector<double> all;
      const FingerSkeleton& skeleton = human_hand().fingers[static_cast<std::size_t>(finger)];
      const auto joints = finger_joints(skeleton, posture.col(finger));
      for (std::size_t bone = 1; bone < kBonesPerFinger; ++bone) {
        double nearest = 1.0;
        for (double share = 0.0; share <= 1.0; share += 0.02) {
          Vector3 off = joints[bone] + share * (joints[bone + 1] - joints[bone]) - grip.bar;
          off.y() = 0.0;
          nearest = std::min(nearest, off.norm());
        }
        all.push_back(radius + skeleton.radius - nearest);
      }
      return all;
    };
    for (int finger = 1; finger < kFingers; ++finger) {
      int pressing = 0;
      for (const double depth : depths(grip.closed, finger)) {
        pressing += depth > 0.002;
        EXPECT_LT(depth, 0.006) << radius << ", finger " << finger;
      }
      EXPECT_GE(pressing, 2) << radius << ", finger " << finger;
      for (const double depth : depths(grip.near, finger)) EXPECT_LT(depth, 0.0) << radius;
    }
  }
}

}  // namespace
}  // namespace mrhi
