#include <gtest/gtest.h>

#include "mr_hand_interaction/scene/object_request.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/simulation.h"
#include "scene/scene_files.h"
#include "support/joints.h"

namespace mrhi {
namespace {

const std::string kPart = std::string(test::kInertial) + test::kBox;

std::string joint(const std::string& name, const std::string& type, const std::string& parent,
                  const std::string& child, const std::string& more = "", const std::string& origin = "") {
  return "<joint name=\"" + name + "\" type=\"" + type + "\"><parent link=\"" + parent +
         "\"/><child link=\"" + child + "\"/><origin " + origin + "/><axis xyz=\"0 0 1\"/>" + more +
         "</joint>\n";
}

const std::string kLimit = R"(<limit lower="-0.5" upper="1.5" effort="1" velocity="1"/>)";
const std::string kDynamics = R"(<dynamics damping="0.2" friction="0.3"/>)";

/// A frame, a door on it, a lever on the door; a free ball with an arm.
std::string workshop() {
  return test::robot(test::link("frame", test::kBox) + test::link("door", kPart) +
                     test::link("lever", kPart) + test::link("base", kPart) + test::link("arm", kPart) +
                     joint("f", "fixed", "world", "frame", "", R"(xyz="1 0 0")") +
                     joint("hinge", "revolute", "frame", "door", kLimit + kDynamics, R"(xyz="0 0.2 0")") +
                     joint("rail", "prismatic", "door", "lever", kLimit, R"(xyz="0.2 0 0")") +
                     joint("b", "floating", "world", "base", "", R"(xyz="-0.5 0 0")") +
                     joint("elbow", "continuous", "base", "arm", "", R"(xyz="0 0 0.3")"));
}

Scene load(const std::string& urdf, const std::string& yaml = "") {
  const test::Folder folder;
  folder.write("test.yaml", yaml);
  return load_scene(folder.write("test.urdf", urdf), {});
}

std::string error(const std::string& urdf, const std::string& yaml = "") {
  const test::Folder folder;
  folder.write("test.yaml", yaml);
  return test::scene_error(folder.write("test.urdf", urdf));
}

TEST(JointScene, has_the_joints_of_its_urdf) {
  const Scene scene = load(workshop());
  ASSERT_EQ(scene.joints.size(), 3u);
  const Joint& hinge = scene.joints[static_cast<std::size_t>(*find_joint(scene, "hinge"))];
  EXPECT_EQ(hinge.kind, JointKind::turning);
  EXPECT_EQ(hinge.lower, -0.5);
  EXPECT_EQ(hinge.upper, 1.5);
  EXPECT_EQ(hinge.damping, 0.2);
  EXPECT_EQ(hinge.friction, 0.3);
  EXPECT_EQ(hinge.parent, *find_body(scene, "frame"));
  EXPECT_EQ(scene.joints[static_cast<std::size_t>(*find_joint(scene, "rail"))].kind, JointKind::sliding);
  EXPECT_FALSE(scene.joints[static_cast<std::size_t>(*find_joint(scene, "elbow"))].is_limited());
  const auto place = [&](const char* name) {
    return scene.bodies[static_cast<std::size_t>(*find_body(scene, name))].start.position;
  };
  EXPECT_LT((place("door") - Vector3(1, 0.2, 0)).norm(), 1e-15);
  EXPECT_LT((place("lever") - Vector3(1.2, 0.2, 0)).norm(), 1e-15);
  EXPECT_LT((place("arm") - Vector3(-0.5, 0, 0.3)).norm(), 1e-15);
}

TEST(JointScene, a_link_without_a_shape_passes_on_what_hangs_on_it) {
  const std::string frame =
      test::link("frame", test::kBox) + joint("f", "fixed", "world", "frame", "", R"(xyz="1 0 0")") +
      test::link("bracket", "") + joint("b", "fixed", "frame", "bracket", "", R"(xyz="0 0.2 0")");
  const Scene scene =
      load(test::robot(frame + test::link("door", kPart) +
                       joint("hinge", "revolute", "bracket", "door", kLimit, R"(xyz="0 0 0.3")")));
  ASSERT_EQ(scene.joints.size(), 1u);
  EXPECT_EQ(scene.joints[0].parent, *find_body(scene, "frame"));
  const Body& door = scene.bodies[static_cast<std::size_t>(*find_body(scene, "door"))];
  const Vector3 link = (door.start * door.link_in_body).position;
  EXPECT_LT((link - Vector3(1.0, 0.2, 0.3)).norm(), 1e-12);
}

TEST(JointScene, begins_where_its_yaml_has_it) {
  const Scene scene = load(workshop(), "joints: {hinge: {start: 1.0}, rail: {start: 0.1}}");
  const Vector3 lever = scene.bodies[static_cast<std::size_t>(*find_body(scene, "lever"))].start.position;
  EXPECT_LT((lever - Vector3(1 + 0.2 * std::cos(1.0), 0.2 + 0.2 * std::sin(1.0), 0.1)).norm(), 1e-12);
}

TEST(JointScene, has_springs_detents_and_latches_of_its_yaml) {
  const Scene scene =
      load(workshop(),
           "joints:\n  hinge: {spring: {stiffness: 2, rest: 0.1}, restitution: 0.4}\n"
           "  rail: {detents: {at: [0, 0.02], force: 3}, latch: {at: 0, force: 5, reach: 0.01}}\n");
  const Joint& hinge = scene.joints[static_cast<std::size_t>(*find_joint(scene, "hinge"))];
  const Joint& rail = scene.joints[static_cast<std::size_t>(*find_joint(scene, "rail"))];
  EXPECT_EQ(hinge.spring->stiffness, 2.0);
  EXPECT_EQ(hinge.spring->rest, 0.1);
  EXPECT_EQ(hinge.restitution, 0.4);
  EXPECT_EQ(rail.detents->at.size(), 2u);
  EXPECT_EQ(rail.latch->force, 5.0);
}

TEST(JointScene, refuses_in_one_line_what_makes_no_tree_or_is_out_of_limits) {
  const std::string door = test::link("frame", test::kBox) + test::link("door", kPart) +
                           joint("f", "fixed", "world", "frame", "", R"(xyz="1 0 0")");
  const std::string good = test::robot(door + joint("hinge", "revolute", "frame", "door", kLimit));
  test::expect_words(error(good, "joints: {hnge: {start: 0}}"), {"'hnge'", "hinge"});
  test::expect_words(error(good, "joints: {hinge: {start: 3}}"), {"'hinge'", "start 3"});
  test::expect_words(error(good, "joints: {hinge: {friction: -1}}"), {"'hinge'", "friction -1"});
  test::expect_words(error(good, "joints: {hinge: {spring: {stiffness: soft}}}"), {"stiffness", "number"});
  test::expect_words(error(good, "joints: {hinge: {detents: {at: [0], force: 1}}}"), {"'hinge'", "detents"});
  for (const char* const axis : {"1e200 0 0", "0 0 1e-9", "0 0 0"}) {
    std::string turned = good;
    turned.replace(turned.rfind("0 0 1\""), 5, axis);
    test::expect_words(error(turned), {"'hinge'", std::string("axis [") + (axis[0] == '1' ? "1e+200" : "0"),
                                       "a direction, its length a number from 1e-06 to 1000"});
  }
}

TEST(JointScene, limits_that_are_none_and_mimic_load_with_a_warning) {
  const std::string door = test::link("frame", test::kBox) + test::link("door", kPart) +
                           joint("f", "fixed", "world", "frame", "", R"(xyz="1 0 0")");
  for (const std::string& inside : {std::string(R"(<limit lower="1" upper="0" effort="1" velocity="1"/>)"),
                                    kLimit + R"(<mimic joint="other"/>)"})
    EXPECT_EQ(error(test::robot(door + joint("hinge", "revolute", "frame", "door", inside))), "");
}

/// Upper arm, elbow and forearm, of which the first and the last are inside each other.
TEST(JointScene, links_of_a_mechanism_that_overlap_load_with_a_warning_and_do_not_push_each_other) {
  const std::string arm = test::link("upper", kPart) + test::link("elbow", kPart) +
                          test::link("fore", kPart) + joint("u", "floating", "world", "upper") +
                          joint("a", "continuous", "upper", "elbow") +
                          joint("b", "continuous", "elbow", "fore", "", R"(xyz="0.02 0 0")");
  Scene scene = load(test::robot(arm));
  ASSERT_EQ(scene.warnings.size(), 1u);
  test::expect_words(scene.warnings[0], {"do not touch each other", "'upper' and 'fore'"});
  Simulation simulation(scene, Configuration());
  simulation.advance({0, {}});
  for (int i = 1; i <= 20; ++i) simulation.advance({i * 10'000'000, {}});
  for (const BodyState& body : simulation.state().bodies) EXPECT_EQ(body.linear_momentum, Vector3::Zero());
  const std::string other = test::link("other", kPart) + joint("o", "floating", "world", "other");
  test::expect_words(error(test::robot(arm + other)), {"'other' is 0.05 m in 'upper'", "at most 0.001 m"});
}

// A drawer touches the side of its cabinet, and another cabinet's; a box that is loose may not.
TEST(JointScene, what_is_joined_to_fixtures_may_overlap_them_and_does_not_touch_them) {
  const std::string cabinet =
      test::link("back", kPart) + test::link("side", kPart) + test::link("drawer", kPart) +
      joint("f", "fixed", "world", "back") + joint("g", "fixed", "world", "side", "", R"(xyz="0.12 0 0")") +
      joint("p", "prismatic", "back", "drawer", R"(<limit lower="0" upper="0.2"/>)", R"(xyz="0.08 0 0")");
  const Scene scene = load(test::robot(cabinet));
  test::expect_words(scene.warnings.at(0), {"do not touch each other", "'side' and 'drawer'"});
  const std::string loose =
      test::link("box", kPart) + joint("o", "floating", "world", "box", "", R"(xyz="0.16 0 0")");
  test::expect_words(error(test::robot(cabinet + loose)), {"'box' is", "in 'side'"});
}

TEST(JointScene, refuses_a_chain_of_more_than_32_in_a_file_and_in_what_is_spawned) {
  const auto chain = [](int links) {
    std::string content;
    for (int i = 0; i < links; ++i) {
      const std::string name = "link" + std::to_string(i);
      content += test::link(name, kPart) + joint("j" + std::to_string(i), "continuous",
                                                 i == 0 ? "world" : "link" + std::to_string(i - 1), name, "",
                                                 R"(xyz="0.1 0 0")");
    }
    return test::robot(content);
  };
  const std::vector<std::string> words{"the mechanism of joint 'j0' has more than 32 joints",
                                       "256 in a scene"};
  const std::string wide = "bounds: {min: [-9, -9, -9], max: [9, 9, 9]}";
  EXPECT_EQ(error(chain(32), wide), "");
  test::expect_words(error(chain(33), wide), words);
  ObjectRequest request;
  request.whole = true;
  request.urdf = chain(32);
  EXPECT_NO_THROW(requested_scene(request, {}));
  request.urdf = chain(33);
  try {
    requested_scene(request, {});
    FAIL() << "it was taken";
  } catch (const SceneError& refusal) {
    test::expect_words(refusal.what(), words);
  }
}

TEST(JointScene, what_is_spawned_is_refused_where_its_joints_begin_beyond_their_limits) {
  ObjectRequest request;
  request.whole = true;
  request.urdf = workshop();
  request.joints = "hinge: {start: 1.0}";
  EXPECT_NO_THROW(requested_scene(request, {}));
  request.joints = "hinge: {start: 1.6}";
  try {
    requested_scene(request, {});
    FAIL() << "it was taken";
  } catch (const SceneError& refusal) {
    test::expect_words(refusal.what(), {"spawn", "'hinge'", "1.6"});
  }
}

TEST(JointScene, refuses_a_loop_of_joints) {
  Scene scene = testing::pendulum(2, 0.0, 0.0);
  scene.joints[0].parent = 1;
  try {
    arrange_joints(scene);
    FAIL() << "a loop was taken";
  } catch (const std::invalid_argument& error) {
    test::expect_words(error.what(), {"'joint_0'", "loop"});
  }
}

TEST(JointScene, a_state_that_knows_no_joints_has_them_where_they_begin) {
  Simulation simulation(testing::pendulum(2, 0.3, 9.81), testing::unfiltered(ContactModelKind::implicit));
  SimulationState state = simulation.state();
  testing::let_go_on(simulation, 0.0, 0.2, 100.0, [](const Simulation&) {});
  ASSERT_NE(simulation.state().joints[0].position, 0.3);
  state.joints.clear();
  simulation.set_state(state);
  ASSERT_EQ(simulation.state().joints.size(), 2u);
  EXPECT_EQ(simulation.state().joints[0].position, 0.3);
}

TEST(JointScene, a_body_that_leaves_is_put_back_with_all_that_hangs_on_it_and_no_other_is) {
  Scene scene = testing::pendulum(4, 0.0, 0.0);
  scene.joints = {scene.joints[1], scene.joints[3]};  // two pairs
  scene.bodies[2].start.position = {0, 0.3, 0};
  for (int b = 0; b < 4; ++b)
    scene.bodies[static_cast<std::size_t>(b)].start_twist.linear =
        b < 2 ? Vector3(1, 0, 0) : Vector3(0, 0.1, 0);
  scene.bounds = {{-0.5, -0.5, -0.5}, {0.5, 0.5, 0.5}};
  Simulation simulation(scene, testing::unfiltered(ContactModelKind::implicit));
  int told = 0;
  testing::let_go_on(simulation, 0.0, 0.7, 100.0, [&](const Simulation& now) {
    for (const Event& event : now.result().events) told += event.kind == EventKind::out_of_bounds;
    EXPECT_LT(testing::apart(now, 0).place, 1e-12);
  });
  EXPECT_EQ(told, 1);
  EXPECT_NEAR(simulation.state().bodies[2].pose.position.y(), 0.3 + 0.1 * 0.7, 1e-9);
}

}  // namespace
}  // namespace mrhi
