#include <gtest/gtest.h>

#include "mr_hand_interaction/simulation.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "scene/scene_files.h"
#include "synthetic/performance.h"

namespace mrhi {
namespace {

/// A URDF of one object, as its root, or turned on a floating joint.
struct Object {
  const char* name;
  std::string collisions;
  const char* rpy = "0 0 0";
};

std::string collision(const std::string& shape, const std::string& origin = "") {
  return "<collision>" + origin + "<geometry>" + shape + "</geometry></collision>";
}

Scene scene_of(const test::Folder& folder, const Object& object) {
  return load_scene(folder.write("object.urdf",
                                 test::thing("<inertial><mass value=\"0.1\"/></inertial>" + object.collisions,
                                             std::string("xyz=\"0.05 0.1 0.3\" rpy=\"") + object.rpy + "\"")),
                    {});
}

/// Four walls, a floor that is the narrowest through the centre, but that no hand reaches, and a handle.
std::string mug() {
  const std::string wall = R"(<box size="0.06 0.003 0.08"/>)", across = R"(<box size="0.003 0.06 0.08"/>)";
  return collision(wall, R"(<origin xyz="0 -0.0285 0"/>)") +
         collision(wall, R"(<origin xyz="0 0.0285 0"/>)") +
         collision(across, R"(<origin xyz="-0.0285 0 0"/>)") +
         collision(across, R"(<origin xyz="0.0285 0 0"/>)") +
         collision(R"(<box size="0.06 0.06 0.003"/>)", R"(<origin xyz="0 0 -0.0385"/>)") +
         collision(R"(<box size="0.008 0.01 0.05"/>)", R"(<origin xyz="0.052 0 0"/>)") +
         collision(R"(<box size="0.02 0.01 0.008"/>)", R"(<origin xyz="0.04 0 0.021"/>)") +
         collision(R"(<box size="0.02 0.01 0.008"/>)", R"(<origin xyz="0.04 0 -0.021"/>)");
}

class GraspObject : public ::testing::TestWithParam<Object> {};

// Carried by 80 mm: 60 mm of that, in the hand, while it has not opened.
TEST_P(GraspObject, is_held_and_carried) {
  const test::Folder folder;
  const Scene scene = scene_of(folder, GetParam());
  const ScriptedMotion motion = grasp_object(scene);
  SyntheticHand source({}, motion);
  Simulation simulation(scene, Configuration());
  double carried = 0.0;
  while (source.next_run() == 0) {
    JointsFrame joints = source.next();
    HandFrame frame{joints.stamp, {}};
    for (const HandJoints& hand : joints.hands)
      frame.hands.push_back(complete_hand(hand, default_device_mount()));
    ASSERT_EQ(simulation.advance(frame), Rejection::none);
    if (frame.hands.empty() || to_seconds(joints.stamp) > testing::opening_from(motion)) break;
    if (simulation.state().interactions.at(0).level == InteractionLevel::grasp)
      carried = (simulation.state().bodies.at(0).pose.position - scene.bodies[0].start.position).norm();
  }
  EXPECT_GT(carried, 0.06);
}

INSTANTIATE_TEST_SUITE_P(
    , GraspObject,
    ::testing::Values(Object{"box", collision(R"(<box size="0.08 0.06 0.03"/>)")},
                      Object{"turned_box", collision(R"(<box size="0.03 0.08 0.06"/>)"), "0.4 0.7 1.9"},
                      Object{"can", collision(R"(<cylinder radius="0.033" length="0.1"/>)")},
                      Object{"lying_can", collision(R"(<cylinder radius="0.025" length="0.1"/>)"),
                             "1.5708 0 0.5"},
                      Object{"ball", collision(R"(<sphere radius="0.033"/>)")}, Object{"mug", mug()},
                      Object{"turned_mug", mug(), "0.4 0.7 1.9"},
                      Object{"pen", collision(R"(<capsule radius="0.006" length="0.12"/>)"), "0 1.5708 0"},
                      Object{"plate", collision(R"(<box size="0.09 0.09 0.012"/>)"), "0 0 0.3"}),
    [](const auto& object) { return std::string(object.param.name); });

TEST(GraspObjectOf, needs_one_free_object_that_a_hand_closes_on) {
  const test::Folder folder;
  const auto refusal = [](const Scene& scene) -> std::string {
    try {
      grasp_object(scene);
    } catch (const std::invalid_argument& error) {
      return error.what();
    }
    return "";
  };
  test::expect_words(refusal(scene_of(folder, {"crate", collision(R"(<box size="0.3 0.3 0.3"/>)")})),
                     {"'thing'", "0.3 m wide on its narrowest side", "0.09 m"});
  Scene two = scene_of(folder, {"box", test::kBox});
  two.bodies.push_back(two.bodies[0]);
  test::expect_words(refusal(two), {"2 free objects", "allowed: one"});
}

}  // namespace
}  // namespace mrhi
