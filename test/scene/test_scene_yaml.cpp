#include <gtest/gtest.h>

#include "scene/scene_files.h"

namespace mrhi {
namespace {

/// A scene of one free body `thing` at the origin and this YAML beside it.
class SceneYaml : public ::testing::Test {
 protected:
  Scene load(const std::string& yaml, const SceneOptions& options = {}) {
    folder_.write("test.yaml", yaml);
    return load_scene(urdf_, options);
  }
  std::string error(const std::string& yaml, const SceneOptions& options = {}) {
    folder_.write("test.yaml", yaml);
    return test::scene_error(urdf_, options);
  }

  test::Folder folder_;
  std::string urdf_ = folder_.write("test.urdf", test::thing(std::string(test::kInertial) + test::kBox));
};

TEST_F(SceneYaml, IsOptionalAndSoIsAllInIt) {
  for (const Scene& scene : {load_scene(urdf_, {}), load(""), load("gravity: [0, 0, 0]")}) {
    EXPECT_EQ("test", scene.name);
    EXPECT_EQ(Vector3::Zero(), scene.gravity);
    EXPECT_EQ(Bounds().max, scene.bounds.max);
    EXPECT_EQ(Material().stiffness, scene.bodies.at(0).material.stiffness);
  }
}

TEST_F(SceneYaml, MayHaveASectionWhoseLinesAreAllCommentedOut) {
  EXPECT_EQ(1u, load("materials:\n#  thing: {restitution: 0.5}\ntwists:\n").bodies.size());
  test::expect_words(error("materials: {thing: }"), {"materials/thing", "nothing is not allowed"});
}

TEST_F(SceneYaml, SetsWhatItNames) {
  const Scene scene = load(
      "gravity: [0, 0.5, -9.81]\n"
      "bounds: {min: [-1, -2, -3]}\n"
      "materials:\n  thing: {restitution: 1, stiffness: 2e3}\n");
  EXPECT_EQ(Vector3(0, 0.5, -9.81), scene.gravity);
  EXPECT_EQ(Vector3(-1, -2, -3), scene.bounds.min);
  EXPECT_EQ(Bounds().max, scene.bounds.max);
  EXPECT_EQ(1, scene.bodies.at(0).material.restitution);
  EXPECT_EQ(2000, scene.bodies.at(0).material.stiffness);
}

TEST_F(SceneYaml, ItsMaterialsStandAboveTheDefaultsAndItsGravityBelowTheOption) {
  SceneOptions options;
  options.default_material.restitution = 0.9;
  options.default_material.stiffness = 7;
  options.gravity = Vector3(0, 0, -1.62);
  const Scene scene = load("gravity: [0, 0, -9.81]\nmaterials: {thing: {stiffness: 300}}", options);
  EXPECT_EQ(300, scene.bodies.at(0).material.stiffness);
  EXPECT_EQ(0.9, scene.bodies.at(0).material.restitution);
  EXPECT_EQ(Vector3(0, 0, -1.62), scene.gravity);
}

TEST_F(SceneYaml, SaysHowObjectsAreGrasped) {
  EXPECT_EQ(GraspMode::parameter, load("").bodies.at(0).grasp);
  for (const GraspMode mode : {GraspMode::free, GraspMode::assist, GraspMode::never})
    EXPECT_EQ(mode, load("grasp: {thing: " + name_of(mode) + "}").bodies.at(0).grasp);
  test::expect_words(error("grasp: {thing: sometimes}"),
                     {"test.yaml:1", "grasp/thing", "sometimes", "free, assist or never"});
  test::expect_words(error("grasp: {thin: never}"), {"test.yaml:1", "'thin'", "thing"});
}

// A linkage that floats has the mode of the body that it hangs on.
TEST_F(SceneYaml, AFloatingLinkageIsGraspedAsAWhole) {
  const std::string content = std::string(test::kInertial) + test::kBox;
  urdf_ = folder_.write("test.urdf", test::robot(test::link("base", content) + test::link("lid", content) +
                                                 test::joint("floating", "world", "base") +
                                                 test::joint("continuous", "base", "lid")));
  const Scene scene = load("grasp: {base: never}");
  EXPECT_EQ(GraspMode::never, grasp_of(scene, *find_body(scene, "lid")));
  test::expect_words(error("grasp: {lid: never}"), {"'lid'", "allowed: base"});
}

TEST_F(SceneYaml, RefusesUnknownKeysAndLinks) {
  test::expect_words(error("gravty: [0, 0, 0]"),
                     {"test.yaml:1", "'gravty'", "gravity, bounds, materials, grasp, twists, joints"});
  test::expect_words(error("bounds: {low: [0, 0, 0]}"), {"bounds", "'low'", "min, max"});
  test::expect_words(error("materials:\n  thin: {restitution: 0}"),
                     {"test.yaml:", "materials", "'thin'", "thing"});
  test::expect_words(error("materials: {thing: {bounce: 1}}"),
                     {"materials/thing", "'bounce'", "restitution, static_"});
  test::expect_words(error("materials: {thing: {restitution: 1, restitution: 0}}"), {"restitution", "twice"});
}

TEST_F(SceneYaml, RefusesValuesOfAWrongTypeOrOutOfRange) {
  test::expect_words(error("gravity: 9.81"), {"gravity", "9.81", "three numbers"});
  test::expect_words(error("gravity: [0, 0]"), {"gravity", "[0, 0]", "three"});
  test::expect_words(error("gravity: [0, 0, .inf]"), {"gravity", "three numbers", "-100 to 100"});
  test::expect_words(error("bounds: 3"), {"bounds", "3", "min, max"});
  test::expect_words(error("bounds: {min: [0, 0, 3], max: [1, 1, 3]}"), {"bounds", "[0, 0, 3]", "below"});
  test::expect_words(error("- 1\n- 2"), {"gravity, bounds, materials"});
  const auto material = [this](const std::string& text) {
    return error("materials: {thing: {" + text + "}}");
  };
  test::expect_words(material("restitution: 1.5"), {"materials/thing/restitution", "1.5", "from 0 to 1"});
  test::expect_words(material("static_friction: -1"),
                     {"materials/thing/static_friction", "-1", "from 0 to 10"});
  test::expect_words(material("dynamic_friction: .nan"), {"dynamic_friction", ".nan", "from 0 to 10"});
  test::expect_words(material("stiffness: 0"), {"materials/thing/stiffness", "from 1 to", "N/m"});
  test::expect_words(material("stiffness: hard"), {"materials/thing/stiffness", "hard"});
}

TEST_F(SceneYaml, RefusesDynamicFrictionAboveStatic) {
  test::expect_words(error("materials: {thing: {static_friction: 0.5}}"),
                     {"materials/thing", "dynamic_friction 0.6", "static_friction 0.5"});
}

TEST_F(SceneYaml, RefusesWhatIsNoYaml) {
  test::expect_words(error("gravity: [0, 0\nbounds: }"), {"test.yaml:", "not YAML"});
}

TEST_F(SceneYaml, RefusesABodyThatStartsOutOfBounds) {
  test::expect_words(error("bounds: {min: [0.1, -1, -1], max: [1, 1, 1]}"),
                     {"'thing'", "[0, 0, 0]", "[0.1, -1, -1]"});
}

}  // namespace
}  // namespace mrhi
