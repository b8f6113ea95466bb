#include <cmath>
#include <filesystem>

#include "scene/scene_files.h"
#include "training/operator_trial.h"
#include "training/trials.h"

namespace mrhi {
namespace {

const std::string kHead = "name: t\nobjects: [{name: cube, position: [0, 0, 0.2]}]\n";
const std::string kGoals = "goals:\n  - pick: {}\n";

class TaskFile : public ::testing::Test {
 protected:
  Task load(const std::string& yaml) { return load_task(folder_.write("task.yaml", yaml)); }
  /// The message of the refusal, checked to be one line that begins with the file.
  std::string error(const std::string& yaml) {
    try {
      load(yaml);
    } catch (const SceneError& refusal) {
      const std::string message = refusal.what();
      EXPECT_EQ(std::string::npos, message.find('\n')) << message;
      EXPECT_EQ(0u, message.find(folder_.path() + "/task.yaml")) << message;
      return message;
    }
    return "";
  }
  std::string goal_error(const std::string& goal) { return error(kHead + "goals:\n  - " + goal + "\n"); }

  test::Folder folder_;
};

TEST_F(TaskFile, sets_what_it_names_and_has_defaults_for_the_rest) {
  const Task task =
      load(kHead + "goals:\n  - pick:\n  - place: {position: [0.1, 0, 0.2]}\n  - release: {}\n");
  EXPECT_EQ("t", task.name);
  EXPECT_EQ("cube", task.objects.at(0).file);
  EXPECT_EQ(0.2, task.objects.at(0).start.position.z());
  EXPECT_TRUE(task.latin_square);
  EXPECT_EQ(1, task.repetitions);
  EXPECT_EQ(120.0, task.time_out);
  ASSERT_EQ(3u, task.goals.size());
  EXPECT_EQ(0.05, task.goals[0].distance);
  EXPECT_EQ(3.0, task.goals[1].hold);
  EXPECT_FALSE(task.goals[1].angle_tolerance);
  EXPECT_EQ(2.0, task.goals[2].drift_time);
}

TEST_F(TaskFile, reads_every_key) {
  const Task task = load(
      "name: all\ninstructions: Do it\ngravity: [0, 0, -9.81]\norder: as_listed\nrepetitions: 2\ntime_out: "
      "30\n"
      "objects:\n  - {name: a, file: a.urdf, position: [0, 0, 0], orientation: [0, 0, 1, 0], twist: [1, 2, "
      "3, 4, 5, 6]}\n"
      "fixtures: [{name: wall, file: wall.urdf, position: [1, 1, 1], orientation: [1, 0, 0, 0]}]\n"
      "goals:\n"
      "  - pick: {distance: 0.1, instruction: Up}\n"
      "  - place: {position: [1, 0, 0], orientation: [0, 0, 0, 1], tolerance: 0.01, angle_tolerance: 90, "
      "hold: 1, "
      "leaving: stop}\n"
      "  - insert: {position: [2, 0, 0], axis: [0, 0, 2], angle_tolerance: 5}\n"
      "  - release: {drift_time: 1}\n");
  EXPECT_EQ(-9.81, task.gravity.z());
  EXPECT_FALSE(task.latin_square);
  EXPECT_EQ(folder_.path() + "/a.urdf", task.objects[0].file);
  EXPECT_EQ(1.0, task.objects[0].start.orientation.z());
  EXPECT_EQ(6.0, task.objects[0].twist.angular.z());
  EXPECT_EQ(1.0, task.fixtures.at(0).start.position.x());
  EXPECT_EQ("Up", instruction(task, 0, "a"));
  EXPECT_NEAR(M_PI / 2, *task.goals[1].angle_tolerance, 1e-12);
  EXPECT_EQ(Leaving::stop, task.goals[1].leaving);
  EXPECT_EQ(Vector3::UnitZ(), *task.goals[2].axis);
  EXPECT_EQ(2u, task.places());
  EXPECT_EQ(0u, task.place_number(0));
  EXPECT_EQ(2u, task.place_number(2));
}

TEST_F(TaskFile, refuses_unknown_and_missing_keys) {
  test::expect_words(error(kHead + kGoals + "timeout: 3\n"), {":", "'timeout'", "time_out"});
  test::expect_words(error("name: t\n" + kGoals), {"'objects'", "needed"});
  test::expect_words(error(kHead), {"'goals'", "needed"});
  test::expect_words(goal_error("fly: {}"), {"goals/1", "'fly'", "nudge_into"});
  test::expect_words(goal_error("place: {hold: 1}"), {"goals/1/place", "'position'"});
  test::expect_words(goal_error("pick: {position: [0, 0, 0]}"), {"goals/1/pick", "'position'", "distance"});
  test::expect_words(error("name: t\nobjects: [{name: a}]\n" + kGoals), {"objects/1", "'position'"});
  test::expect_words(error(kHead + "name: again\n" + kGoals), {"name", "twice"});
}

TEST_F(TaskFile, refuses_wrong_types_and_what_is_out_of_range) {
  test::expect_words(error(kHead + kGoals + "time_out: soon\n"), {"time_out", "soon", "a number above 0"});
  test::expect_words(error(kHead + kGoals + "time_out: 0\n"), {"time_out", "a number above 0"});
  test::expect_words(error(kHead + kGoals + "practice: often\n"), {"practice", "often", "true"});
  test::expect_words(error(kHead + kGoals + "repetitions: 1.5\n"), {"repetitions", "1.5", "whole number"});
  test::expect_words(error(kHead + kGoals + "repetitions: 1001\n"), {"1001", "1 to 1000"});
  EXPECT_EQ(error(kHead + kGoals + "repetitions: 1000\n"), "");
  test::expect_words(error(kHead + kGoals + "gravity: 9.81\n"), {"gravity", "9.81", "three numbers"});
  test::expect_words(error(kHead + kGoals + "order: random\n"),
                     {"order", "random", "latin_square or as_listed"});
  test::expect_words(goal_error("place: {position: [0, 0]}"), {"goals/1/place/position", "three numbers"});
  test::expect_words(goal_error("place: {position: [0, 0, .nan]}"), {"goals/1/place/position"});
  test::expect_words(goal_error("place: {position: [0, 0, 0], tolerance: -1}"),
                     {"tolerance", "-1", "above 0"});
  test::expect_words(goal_error("place: {position: [0, 0, 0], leaving: go}"), {"leaving", "reset or stop"});
  test::expect_words(goal_error("insert: {position: [0, 0, 0], angle_tolerance: 200}"), {"200", "180"});
  test::expect_words(goal_error("insert: {position: [0, 0, 0], angle_tolerance: 5, axis: [0, 0, 0]}"),
                     {"axis"});
  test::expect_words(goal_error("tap: {speed: [0.2, 0.1]}"), {"goals/1/tap/speed", "slowest"});
  test::expect_words(goal_error("catch: {within: 0}"), {"within", "above 0"});
  test::expect_words(goal_error("joint: {name: hinge, above: 2000}"),
                     {"goals/1/joint/above", "2000", "1000"});
  test::expect_words(goal_error("joint: {name: a b, above: 1}"), {"goals/1/joint/name", "a b", "letters"});
  test::expect_words(error("name: a/b\n" + kGoals), {"name", "a/b", "64 letters"});
  test::expect_words(error("name: t\nobjects: []\n" + kGoals), {"objects", "at least one"});
  test::expect_words(
      error("name: t\nobjects:\n  - {name: a, position: [0, 0, 0], twist: [1, 2, 3]}\n" + kGoals),
      {"objects/1/twist", "six"});
  for (const std::string twist : {"[0, 200, 0, 0, 0, 0]", "[0, 0, 0, 0, 2000, 0]"}) {
    test::expect_words(
        error("name: t\nobjects:\n  - {name: a, position: [0, 0, 0], twist: " + twist + "}\n" + kGoals),
        {"objects/1/twist", "100 m/s", "1000 rad/s"});
  }
  test::expect_words(
      error("name: t\nobjects:\n  - {name: a, position: [0, 0, 0], orientation: [0, 0, 0, 2]}\n" + kGoals),
      {"orientation", "unit quaternion"});
  test::expect_words(error("- a\n- b\n"), {"a map with the keys"});
  test::expect_words(error("name: [\n"), {"not YAML"});
}

TEST_F(TaskFile, refuses_what_makes_no_sense_together) {
  test::expect_words(error(kHead + "goals: [{release: {}}, {pick: {}}]\n"), {"goals/1", "release", "last"});
  test::expect_words(error(kHead + "goals: [{release: {}}]\n"), {"goals/1", "release", "held"});
  test::expect_words(error(kHead + "goals: [{slap: {min_speed: 1}}, {release: {}}]\n"), {"goals/2", "held"});
  test::expect_words(error(kHead + "goals: [{place: {position: [0, 0, 0]}}, {pick: {}}]\n"),
                     {"goals/2", "pick after place"});
  test::expect_words(goal_error("joint: {name: hinge}"), {"goals/1/joint", "neither above nor below"});
  test::expect_words(goal_error("rest: {body: object, hold: 1}"),
                     {"goals/1/rest", "neither position, max_speed nor max_spin"});
  test::expect_words(goal_error("rest: {body: hand, max_speed: 1}"),
                     {"goals/1/rest/body", "hand", "object or operator"});
  test::expect_words(goal_error("rest: {body: operator, max_speed: 1}"), {"no key 'scene'"});
  test::expect_words(goal_error("joint: {name: hinge, above: 1, below: 0}"), {"above is more than below"});
  test::expect_words(error(kHead + "goals: [{joint: {name: hinge, above: 1}}, {release: {}}]\n"),
                     {"goals/2", "held"});
  test::expect_words(error("name: t\nobjects:\n  - {name: a, position: [0, 0, 0]}\n  - {name: a, position: "
                           "[1, 0, 0]}\n" +
                           kGoals),
                     {"'a'", "twice"});
}

TEST(ShippedTasks, load_and_name_bodies_that_there_are) {
  int tasks = 0;
  for (const auto& entry : std::filesystem::directory_iterator("config/tasks")) {
    if (entry.path().extension() != ".yaml") continue;
    ++tasks;
    const Task task = load_task(entry.path().string());
    EXPECT_EQ(entry.path().stem().string(), task.name);
    EXPECT_EQ(entry.path().string(),
              std::filesystem::path(find_task_file(task.name, {"config/tasks"})).string());
    EXPECT_FALSE(task.instructions.empty());
    for (const TaskObject& object : task.objects) {
      const ObjectModel model = load_object(object, task.goals, {"config/scenes"}, {});
      EXPECT_EQ(object.name, model.scene.bodies[model.body].name);
      EXPECT_EQ(model.is_device(), model.scene.bodies[model.body].fixed);
    }
    for (const Fixture& fixture : task.fixtures) {
      const Scene scene = load_scene(find_scene_file(fixture.file, {"config/scenes"}), {});
      ASSERT_EQ(1u, scene.bodies.size());
      EXPECT_TRUE(scene.bodies[0].fixed);
    }
  }
  EXPECT_EQ(11, tasks);
}

TEST(ObjectModels, are_refused_without_what_the_task_asks_of_them) {
  const auto error = [](const TaskObject& object, const std::vector<Goal>& goals) -> std::string {
    try {
      load_object(object, goals, {"config/scenes"}, {});
    } catch (const SceneError& wrong) {
      return wrong.what();
    }
    return "";
  };
  Goal goal;
  goal.kind = GoalKind::joint;
  goal.joint = "handle";
  EXPECT_EQ(error({"cube", "cube", {}, {}}, {}), "");
  EXPECT_EQ(error({"wall", "hatch", {}, {}}, {}), "");
  test::expect_words(error({"wall", "hatch", {}, {}}, {goal}),
                     {"hatch", "'handle'", "allowed: ", "hatch_hinge"});
  test::expect_words(error({"cube", "cube", {}, {}}, {goal}), {"'handle'", "no joints"});
  goal.joint = "hatch_hinge";
  goal.above = 1.0;
  EXPECT_EQ(error({"wall", "hatch", {}, {}}, {goal}), "");
  goal.above = 7.0;
  test::expect_words(error({"wall", "hatch", {}, {}}, {goal}), {"'hatch_hinge' beyond its limits", "0 to "});
  goal.above = -2.0, goal.below = -1.0;
  test::expect_words(error({"wall", "hatch", {}, {}}, {goal}), {"'hatch_hinge' beyond its limits", "0 to "});
  test::expect_words(error({"hatch", "hatch", {}, {}}, {}), {"not all hangs on a link 'hatch'"});
  test::expect_words(error({"cube", "mixed", {}, {}}, {}), {"mixed", "one link 'cube'"});
  test::expect_words(error({"wall", "hatch", {}, {Vector3::UnitX(), Vector3::Zero()}}, {}),
                     {"'wall'", "twist", "a lone body"});
  EXPECT_TRUE(load_fixture({"cube", "cube", {}, {}}, {"config/scenes"}, {}).scene.bodies.front().fixed);
  EXPECT_THROW(load_fixture({"wall", "hatch", {}, {}}, {"config/scenes"}, {}), SceneError);
}

TEST(ObjectModels, of_devices_stand_where_the_task_has_them) {
  const Pose there{Vector3(0.1, 0.2, 0.3), Quaternion(Eigen::AngleAxisd(0.5, Vector3::UnitZ()))};
  const ObjectModel here = load_object({"wall", "hatch", {}, {}}, {}, {"config/scenes"}, {});
  const ObjectModel moved = load_object({"wall", "hatch", there, {}}, {}, {"config/scenes"}, {});
  ASSERT_EQ(here.scene.bodies.size(), moved.scene.bodies.size());
  for (std::size_t b = 0; b < here.scene.bodies.size(); ++b) {
    const Pose expected = there * here.scene.bodies[b].start;
    EXPECT_LT((moved.scene.bodies[b].start.position - expected.position).norm(), 1e-12)
        << moved.scene.bodies[b].name;
  }
  EXPECT_TRUE(moved.scene.joints[0].spring || moved.scene.joints[0].latch) << "what the YAML says of it";
}

TEST(ShippedTasks, are_listed_where_another_is_asked_for) {
  try {
    find_task_file("juggle", {"config/tasks"});
    FAIL();
  } catch (const SceneError& error) {
    test::expect_words(
        error.what(),
        {"'juggle'",
         "assemble, catch, dock, hatch, hatch_0g, nudge_into_box, pick_and_place, rail, slap, tap, throw"});
  }
}

TEST(ShippedTasks, pick_and_place_is_the_papers) {
  const Task task = load_task("config/tasks/pick_and_place.yaml");
  ASSERT_EQ(3u, task.objects.size());
  EXPECT_EQ(3u, task.places());
  for (const Goal& goal : task.goals) {
    EXPECT_EQ(goal.stage == TrainingStage::maintenance ? 3.0 : 0.0, goal.hold);
  }
  EXPECT_EQ(GoalKind::release, task.goals.back().kind);
  EXPECT_EQ("Hold the cube at place 2 of 3 for 3 s", instruction(task, 2, "cube"));
}

TEST(Instructions, say_of_each_goal_what_is_to_be_done_and_with_what) {
  Task task = test::two_places();
  const auto said = [&](GoalKind kind) {
    Goal& goal = task.goals[1];
    goal.kind = kind, goal.hold = 2.0, goal.min_speed = 0.5, goal.max_speed = 1.5, goal.joint = "hatch_hinge";
    return instruction(task, 1, "long_cuboid");
  };
  test::expect_words(said(GoalKind::pick), {"Pick up", "the long cuboid"});
  test::expect_words(said(GoalKind::place), {"Hold", "the long cuboid", "place 1 of 2", "2 s"});
  test::expect_words(said(GoalKind::insert), {"Put", "the long cuboid", "2 s"});
  test::expect_words(said(GoalKind::catch_it), {"Catch", "the long cuboid", "2 s"});
  test::expect_words(said(GoalKind::nudge_into), {"Nudge", "the long cuboid", "without grasping"});
  test::expect_words(said(GoalKind::strike), {"Strike", "the long cuboid", "0.5 to 1.5 m/s"});
  test::expect_words(said(GoalKind::joint), {"the hatch hinge"});
  test::expect_words(said(GoalKind::release), {"Let go", "the long cuboid"});
  task.goals[1].instruction = "Do as you like";
  EXPECT_EQ(said(GoalKind::strike), "Do as you like");
}

}  // namespace
}  // namespace mrhi
