#include <gtest/gtest.h>

#include "mr_hand_interaction/live_simulation.h"
#include "mr_hand_interaction/scene/save_scene.h"
#include "scene/scene_files.h"
#include "simulation/operators.h"
#include "support/pinch_scene.h"

namespace mrhi {
namespace {

using testing::at;

/// A free body `thing`, a fixture `loop` and this YAML.
class OperatorScene : public ::testing::Test {
 protected:
  Scene load(const std::string& yaml) {
    folder_.write("test.yaml", yaml);
    return load_scene(urdf_, {});
  }
  std::string error(const std::string& yaml) {
    folder_.write("test.yaml", yaml);
    return test::scene_error(urdf_, {});
  }
  static Body person(const Scene& scene, std::size_t op = 0) {
    return scene.bodies.at(static_cast<std::size_t>(scene.operators.at(op).body));
  }

  test::Folder folder_;
  std::string urdf_ = folder_.write(
      "test.urdf", test::robot(test::link("thing", std::string(test::kInertial) + test::kBox) +
                               test::joint("floating", "world", "thing") + test::link("loop", test::kBox) +
                               test::joint("fixed", "world", "loop", "xyz=\"0 0 0.5\"")));
};

TEST_F(OperatorScene, has_none_unless_the_file_says_so) {
  EXPECT_TRUE(load("gravity: [0, 0, 0]").operators.empty());
  EXPECT_EQ(load("").bodies.size(), 2u);
}

TEST_F(OperatorScene, has_a_person_of_80_kg_by_default_in_a_frame_that_is_world) {
  for (const char* yaml : {"operator: {}", "operator:"}) {
    const Scene scene = load(yaml);
    const Body body = person(scene);
    EXPECT_EQ(body.name, "operator");
    EXPECT_EQ(body.mass, 80.0);
    EXPECT_LT((body.start * body.link_in_body).position.norm(), 1e-15);
    EXPECT_TRUE(body.shapes.empty());
  }
}

TEST_F(OperatorScene, refuses_what_no_person_can_be_with_a_line_that_says_what_can) {
  test::expect_words(error("operator: {mass: 0}"), {"operator/mass", "10", "1000"});
  test::expect_words(error("operator: {inertia: [1, 1, 3]}"), {"operator", "inertia", "sum"});
  test::expect_words(error("operator: {start: [1, 2]}"), {"operator/start", "three or six"});
  test::expect_words(error("operator: {restraint: thing}"), {"operator/restraint", "fixture", "loop"});
  test::expect_words(error("operator: {wings: 2}"), {"wings", "mass, inertia, centre"});
  test::expect_words(error("operators: {thing: {}}"), {"'thing'", "name of its own"});
  test::expect_words(error("operator: {}\noperators: {a: {}}"), {"both", "one of them"});
  test::expect_words(error("tethers: [{body: thing, fixture: loop}]"), {"tethers/1", "'length'"});
  test::expect_words(error("tethers: [{body: loop, fixture: loop, length: 1}]"), {"free body", "thing"});
}

TEST_F(OperatorScene, is_saved_as_it_is_and_keeps_its_parts_when_a_body_goes) {
  const Scene before = load(
      "operators:\n"
      "  ann: {mass: 70, start: [0, 0, 0.1, 0.1, 0.2, 0.3], twist: [0.1, 0, 0, 0, 0.2, 0], restraint: loop}\n"
      "  ben: {inertia: [9, 9, 2], centre: [0, -0.5, 0.1]}\n"
      "tethers: [{body: ben, at: [0, 0, 0.1], fixture: loop, anchor: [0.1, 0, 0], length: 2}]\n");
  save_scene(before, folder_.path() + "/saved.urdf");
  const Scene after = load_scene(folder_.path() + "/saved.urdf", {});
  ASSERT_EQ(after.operators.size(), 2u);
  for (std::size_t o = 0; o < 2; ++o) {
    const Body a = person(before, o), b = person(after, o);
    EXPECT_EQ(a.name, b.name);
    EXPECT_EQ(a.mass, b.mass);
    EXPECT_LT((a.inertia - b.inertia).norm(), 1e-12);
    EXPECT_LT((a.start.position - b.start.position).norm(), 1e-12);
    EXPECT_LT(a.start.orientation.angularDistance(b.start.orientation), 1e-9);
    EXPECT_LT((a.start_twist.linear - b.start_twist.linear).norm(), 1e-15);
    EXPECT_EQ(before.operators[o].restraint.has_value(), after.operators[o].restraint.has_value());
  }
  ASSERT_EQ(after.tethers.size(), 1u);
  EXPECT_LT((before.tethers[0].at - after.tethers[0].at).norm(), 1e-12);
  EXPECT_LT((before.tethers[0].anchor - after.tethers[0].anchor).norm(), 1e-12);

  save_scene(load("operators: {ann: {}}"), folder_.path() + "/one.urdf");
  EXPECT_EQ(person(load_scene(folder_.path() + "/one.urdf", {})).name, "ann");

  LiveSimulation live(after, Configuration());
  live.remove("thing");
  const Scene& less = live.simulation().scene();
  EXPECT_EQ(person(less, 1).name, "ben");
  EXPECT_EQ(less.bodies[static_cast<std::size_t>(less.tethers.at(0).body)].name, "ben");
  live.remove("loop");
  EXPECT_TRUE(live.simulation().scene().tethers.empty());
  EXPECT_FALSE(live.simulation().scene().operators[0].restraint);
  EXPECT_THROW(live.remove("ben"), std::invalid_argument);
}

/// The pinched cube in the hands of an operator who drifts.
Scene held_scene() {
  Scene scene = testing::PinchScene().scene();
  Body body;
  body.name = "operator";
  body.is_operator = true;
  body.mass = 80.0;
  body.inertia = Vector3(11, 12, 1.5).asDiagonal();
  body.link_in_body.position = Vector3(0, 0.4, 0);
  body.start.position = Vector3(0, -0.4, 0);
  body.start_twist = {Vector3(0.02, 0.01, 0), Vector3(0, 0, 0.05)};
  scene.operators.push_back({1, {}, 1.5});
  scene.bodies.push_back(body);
  return scene;
}

void play(Simulation& simulation, int from, int to) {
  const testing::PinchScene pinch;
  for (int frame = from; frame < to; ++frame) {
    const double t = frame / 120.0;
    simulation.advance(
        {at(t), {pinch.hand(t, testing::swing(t, 0.02 * testing::smooth(t - 0.3, 0.2), 2.0))}});
  }
}

TEST(OperatorState, continues_from_a_copy_and_after_live_changes_with_the_same_bits) {
  const Configuration configuration = testing::unfiltered(ContactModelKind::implicit);
  Simulation whole(held_scene(), configuration);
  play(whole, 0, 120);

  Simulation first(held_scene(), configuration);
  play(first, 0, 60);
  Simulation second(held_scene(), configuration);
  second.set_state(first.state());
  play(second, 60, 120);
  EXPECT_EQ(hash(second.state()), hash(whole.state()));

  LiveSimulation live(held_scene(), configuration);
  play(live.simulation(), 0, 60);
  Body far = testing::ball_body(0.02, 0.1);
  far.name = "far";
  far.start.position = Vector3(1, 1, 1);
  live.add(far);
  live.remove("far");
  play(live.simulation(), 60, 120);
  EXPECT_EQ(hash(live.simulation().state()), hash(whole.state()));
  EXPECT_GT(whole.state().bodies[1].linear_momentum.norm(), 1.0);
}

TEST_F(OperatorScene, is_held_by_its_restraint_within_reach_and_let_go_again) {
  LiveSimulation live(load("operator: {restraint: loop, reach: 0.7, twist: [0.3, 0, 0, 0, 0, 0]}"),
                      Configuration());
  Simulation& simulation = live.simulation();
  live.restrain(true);
  const Vector3 place = simulation.state().bodies[2].pose.position;
  for (int frame = 0; frame < 60; ++frame) simulation.advance({at(frame / 60.0), {}});
  EXPECT_EQ(simulation.state().bodies[2].pose.position, place);
  live.reset();
  for (int frame = 0; frame < 60; ++frame) live.simulation().advance({at(frame / 60.0), {}});
  EXPECT_GT(live.simulation().state().bodies[2].pose.position.x(), 0.28);
  for (int frame = 60; frame < 180; ++frame) live.simulation().advance({at(frame / 60.0), {}});
  EXPECT_THROW(live.restrain(true), std::invalid_argument);  // out of its reach by now
  live.restrain(false);
  LiveSimulation without(load("operator: {}"), Configuration());
  EXPECT_THROW(without.restrain(true), std::invalid_argument);
}

TEST_F(OperatorScene, is_off_course_once_its_motion_changes_within_a_frame) {
  constexpr double kFrame = 0.008;
  const Scene scene = load("operator: {}");
  SimulationState state = Simulation(scene, Configuration()).state();
  BodyState& moving = state.bodies.at(static_cast<std::size_t>(scene.operators.at(0).body));
  moving.linear_momentum = 80.0 * Vector3(1.0, 0, 0);
  Operators operators(scene);
  operators.begin_frame(kFrame, state);
  EXPECT_TRUE(operators.begin_step(kFrame, state));
  EXPECT_TRUE(operators.begin_step(0.75 * kFrame, state));
  moving.linear_momentum *= -1.0;
  EXPECT_FALSE(operators.begin_step(0.5 * kFrame, state));
}

/// The hand with id 5 is of the second of two operators: 5 modulo 2.
TEST_F(OperatorScene, hands_are_tracked_in_the_frames_of_their_own_operators) {
  Simulation simulation(load("operators: {ann: {}, ben: {start: [1, 0, 0, 0, 0, 1.570796326794897]}}"),
                        Configuration());
  const Vector3 tip(0.1, 0.2, 0.3);
  HandFrame frame{at(0.0), {testing::finger(tip, tip, 0.008), testing::finger(tip, tip, 0.008)}};
  frame.hands[0].id = 4, frame.hands[1].id = 5;
  frame.hands[0].side = Side::left;
  simulation.advance(frame);
  const auto seen = [&](std::size_t hand) {
    return simulation.result().tracked.at(hand).capsules[capsule_index(1, 3)].start;
  };
  EXPECT_LT((seen(0) - tip).norm(), 1e-12);
  EXPECT_LT((seen(1) - Vector3(1.0 - 0.2, 0.1, 0.3)).norm(), 1e-12);
}

// In their own frames the hands are 0.1 m apart, and Ann's is missing when Ben's appears.
TEST_F(OperatorScene, a_hand_that_appears_is_not_that_of_another_operator_who_holds_it_there) {
  Simulation simulation(load("operators: {ann: {}, ben: {start: [0, 1, 0]}}"), Configuration());
  for (const std::uint32_t id : {4u, 5u}) {
    const Vector3 tip(id == 4 ? 0.2 : 0.1, 0, 0);
    HandFrame frame{at(id / 60.0), {testing::finger(tip, tip, 0.008)}};
    frame.hands[0].id = id;
    simulation.advance(frame);
  }
  const std::vector<Hand>& tracked = simulation.result().tracked;
  ASSERT_EQ(tracked.size(), 2u);
  EXPECT_EQ(tracked[0].id, 4u);
  const Vector3 bens = tracked[1].capsules[capsule_index(1, 3)].start;
  EXPECT_LT((bens - Vector3(0.1, 1, 0)).norm(), 1e-12) << bens.transpose();
}

}  // namespace
}  // namespace mrhi
