#include <gtest/gtest.h>

#include "scene/scene_files.h"

namespace mrhi {
namespace {

using test::joint;
using test::kBox;
using test::kInertial;
using test::link;
using test::robot;
using test::thing;

Scene load(const std::string& urdf) {
  const test::Folder folder;
  return load_scene(folder.write("test.urdf", urdf), {});
}

std::string error(const std::string& urdf) {
  const test::Folder folder;
  return test::scene_error(folder.write("test.urdf", urdf));
}

std::string inertial(const std::string& mass, const Vector3& moments) {
  const auto text = [](double value) { return std::to_string(value); };
  return "<inertial><mass value=\"" + mass + "\"/><inertia ixx=\"" + text(moments.x()) +
         "\" ixy=\"0\" ixz=\"0\" iyy=\"" + text(moments.y()) + "\" iyz=\"0\" izz=\"" + text(moments.z()) +
         "\"/></inertial>";
}

// Turned by 90 degrees about z, the inertia's x axis is the link's y axis.
TEST(UrdfScene, BodyFrameIsAtTheCentreOfMassWithTheLinksAxes) {
  const Scene scene = load(thing(
      R"(<inertial><origin xyz="0.01 0.02 0.03" rpy="0 0 1.5707963267948966"/><mass value="2"/>
         <inertia ixx="1" ixy="0.1" ixz="0" iyy="2" iyz="0" izz="2.5"/></inertial>
         <collision><origin xyz="0.1 0 0" rpy="0 0.5 0"/>
         <geometry><sphere radius="0.05"/></geometry></collision>)",
      R"(xyz="1 0 0.5" rpy="0 0 1.5707963267948966")"));
  const Body& body = scene.bodies.at(0);
  EXPECT_TRUE(body.start.position.isApprox(Vector3(0.98, 0.01, 0.53), 1e-12));
  EXPECT_TRUE((body.start.orientation * Vector3::UnitX()).isApprox(Vector3::UnitY(), 1e-12));
  EXPECT_TRUE(body.link_in_body.position.isApprox(Vector3(-0.01, -0.02, -0.03), 1e-15));
  EXPECT_TRUE(body.link_in_body.orientation.isApprox(Quaternion::Identity()));
  EXPECT_TRUE((body.start * body.link_in_body.position).isApprox(Vector3(1, 0, 0.5), 1e-12));
  Matrix3 expected;
  expected << 2, -0.1, 0, -0.1, 1, 0, 0, 0, 2.5;
  EXPECT_LT((body.inertia - expected).norm(), 1e-12);
  EXPECT_TRUE(body.shapes.at(0).pose.position.isApprox(Vector3(0.09, -0.02, -0.03), 1e-15));
  EXPECT_NEAR(0.05 + Vector3(0.09, 0.02, 0.03).norm(), body.bounding_radius, 1e-12);
}

TEST(UrdfScene, AMassWithoutInertiaHasThatOfItsShapes) {
  const auto inertia = [](const std::string& shapes) -> Matrix3 {
    return load(thing("<inertial><mass value=\"2\"/></inertial>" + shapes)).bodies.at(0).inertia;
  };
  const auto collision = [](const std::string& shape, const std::string& origin = "") {
    return "<collision>" + origin + "<geometry>" + shape + "</geometry></collision>";
  };
  const Matrix3 box = inertia(collision(R"(<box size="0.1 0.2 0.3"/>)"));
  EXPECT_TRUE(box.isApprox(Matrix3(Vector3(0.13, 0.10, 0.05).asDiagonal()) * 2.0 / 12.0, 1e-12));
  const Matrix3 ball = inertia(collision(R"(<sphere radius="0.1"/>)"));
  EXPECT_TRUE(ball.isApprox(0.4 * 2.0 * 0.01 * Matrix3::Identity(), 1e-12));
  const Matrix3 can = inertia(collision(R"(<cylinder radius="0.1" length="0.3"/>)"));
  const double across = 2.0 * (3.0 * 0.01 + 0.09) / 12.0;
  EXPECT_TRUE(can.isApprox(Matrix3(Vector3(across, across, 0.01).asDiagonal()), 1e-12));
  // A capsule is what two balls' halves and a cylinder are.
  const double side = 0.3 * 0.01, ends = 4.0 / 3.0 * 0.001, density = 2.0 / (side + ends);
  const Matrix3 capsule = inertia(collision(R"(<capsule length="0.3" radius = '0.1'></capsule>)"));
  EXPECT_NEAR(capsule(2, 2), density * (0.5 * side * 0.01 + 0.4 * ends * 0.01), 1e-12);
  const double far = 0.15 + 3.0 / 8.0 * 0.1, of_half = (0.4 - 9.0 / 64.0) * 0.01 - 0.2 * 0.01;
  EXPECT_NEAR(capsule(0, 0),
              density * (side * (0.25 * 0.01 + 0.09 / 12.0) + ends * (0.2 * 0.01 + of_half + far * far)),
              1e-12);
  // Two halves of the box, side by side, are the box.
  const Matrix3 halves = inertia(collision(R"(<box size="0.1 0.2 0.15"/>)", R"(<origin xyz="0 0 0.075"/>)") +
                                 collision(R"(<box size="0.2 0.1 0.15"/>)",
                                           R"(<origin xyz="0 0 -0.075" rpy="0 0 1.5707963267948966"/>)"));
  EXPECT_TRUE(halves.isApprox(box, 1e-12));
}

TEST(UrdfScene, FixedLinksAreFixturesHoweverTheyAreChained) {
  const Scene scene = load(robot(
      link("frame", "") + link("post", kBox) + link("arm", kBox) +
      joint("fixed", "world", "frame", R"(xyz="0 0 1" rpy="0 0 1.5707963267948966")") +
      joint("fixed", "frame", "post", R"(xyz="1 0 0")") + joint("fixed", "post", "arm", R"(xyz="1 0 0")")));
  ASSERT_EQ(2u, scene.bodies.size()) << "a link without geometry is no body";
  EXPECT_TRUE(scene.bodies[0].fixed && scene.bodies[1].fixed);
  EXPECT_TRUE(scene.bodies[find_body(scene, "arm").value()].start.position.isApprox(Vector3(0, 2, 1), 1e-12));
}

TEST(UrdfScene, BodiesKeepTheOrderOfTheFile) {
  const std::string content = std::string(kInertial) + kBox;
  const Scene scene = load(robot("<!-- <link name=\"b\"/> -->" + link("z", content) + link("a", content) +
                                 link("b", content) + joint("floating", "world", "a") +
                                 joint("floating", "world", "b", "xyz=\"0.1 0 0\"") +
                                 joint("floating", "world", "z", "xyz=\"0.2 0 0\"")));
  ASSERT_EQ(3u, scene.bodies.size());
  EXPECT_EQ("z", scene.bodies[0].name);
  EXPECT_EQ("a", scene.bodies[1].name);
  EXPECT_EQ("b", scene.bodies[2].name);
  EXPECT_EQ(1, find_body(scene, "a"));
  EXPECT_FALSE(find_body(scene, "c"));
}

TEST(UrdfScene, ALinkMayHaveSeveralShapesAndColours) {
  const Scene scene =
      load(thing(std::string(kInertial) + kBox +
                 R"(<collision><geometry><cylinder radius="0.01" length="0.2"/></geometry></collision>
         <visual><geometry><box size="1 1 1"/></geometry>
           <material name="red"><color rgba="1 0 0 0.5"/></material></visual>
         <visual><geometry><sphere radius="1"/></geometry></visual>)"));
  const Body& body = scene.bodies.at(0);
  ASSERT_EQ(2u, body.shapes.size());
  EXPECT_EQ(0.1, std::get<Cylinder>(body.shapes[1].shape).half_length);
  ASSERT_EQ(2u, body.visuals.size());
  EXPECT_EQ((std::array<float, 4>{{1, 0, 0, 0.5f}}), body.visuals[0].rgba);
  EXPECT_EQ(Visual().rgba, body.visuals[1].rgba);
}

TEST(UrdfScene, AMaterialMayBeNamedOnceForAll) {
  const std::string blue = R"(<material name="blue"><color rgba="0 0 1 1"/></material>)";
  const std::string visual =
      R"(<visual><geometry><sphere radius="1"/></geometry><material name="blue"/></visual>)";
  const Scene scene = load(robot(blue + link("a", kBox + visual) + joint("fixed", "world", "a")));
  EXPECT_EQ((std::array<float, 4>{{0, 0, 1, 1}}), scene.bodies.at(0).visuals.at(0).rgba);
  test::expect_words(error(robot(link("a", kBox + visual) + joint("fixed", "world", "a"))),
                     {"'a'", "'blue'"});
}

TEST(UrdfScene, WhatHasNoVisualIsSeenByItsCollisionShapes) {
  const Scene scene = load(thing(std::string(kInertial) + kBox));
  ASSERT_EQ(1u, scene.bodies.at(0).visuals.size());
  EXPECT_TRUE(std::holds_alternative<Box>(scene.bodies[0].visuals[0].shape));
}

TEST(UrdfScene, RefusesWhatIsNoUrdf) {
  test::expect_words(error(""), {"cannot be read"});
  test::expect_words(error("<robot name=\"x\"><link name=\"a\"></robot>"), {"bad URDF"});
  test::expect_words(error("gravity: [0, 0, 0]"), {"bad URDF"});
  test::expect_words(error("<robot name=\"x\"><link name=\"a\"/><link name=\"a\"/></robot>"),
                     {"'a'", "unique"});
  test::expect_words(error(robot("")), {"no bodies"});
  test::expect_words(test::scene_error("nowhere/none.urdf"), {"none.urdf", "cannot be read"});
}

TEST(UrdfScene, RefusesAWrongMass) {
  for (const char* mass : {"0", "-0.1"}) {
    test::expect_words(error(thing(inertial(mass, {1, 1, 1}) + kBox)),
                       {"'thing'", "mass", mass, "from 1e-06 to 1e+06 kg"});
  }
  test::expect_words(error(thing(inertial("heavy", {1, 1, 1}) + kBox)), {"heavy", "thing"});
  test::expect_words(error(thing(inertial("nan", {1, 1, 1}) + kBox)), {"nan"});
}

TEST(UrdfScene, RefusesAnInertiaThatNoRigidBodyHas) {
  test::expect_words(error(thing(inertial("1", {1, 1, -1}) + kBox)), {"'thing'", "inertia", "[-1, 1, 1]"});
  test::expect_words(error(thing(inertial("1", {1, 1, 3}) + kBox)),
                     {"'thing'", "inertia", "[1, 1, 3]", "sum"});
  EXPECT_EQ("", error(thing(inertial("1", {1, 1, 2.01}) + kBox))) << "a thin plate, rounded";
}

TEST(UrdfScene, RefusesAFreeBodyWithoutInertialOrCollision) {
  test::expect_words(error(thing(kBox)), {"'thing'", "inertial"});
  test::expect_words(error(thing(kInertial)), {"'thing'", "collision", "255"});
}

TEST(UrdfScene, RefusesMoreShapesThanAContactCanName) {
  std::string boxes;
  for (int i = 0; i < 255; ++i) boxes += kBox;
  EXPECT_EQ(255u, load(thing(kInertial + boxes)).bodies.at(0).shapes.size());
  test::expect_words(error(thing(kInertial + boxes + kBox)), {"'thing'", "256", "255"});
}

TEST(UrdfScene, RefusesSizesThatAreNotPositive) {
  const auto with = [](const std::string& geometry) {
    return thing(kInertial + ("<collision><geometry>" + geometry + "</geometry></collision>"));
  };
  test::expect_words(error(with(R"(<box size="0.1 0 0.1"/>)")),
                     {"'thing' collision 1", "box", "[0.1, 0, 0.1]"});
  test::expect_words(error(with(R"(<sphere radius="-1"/>)")), {"'thing' collision 1", "sphere", "-1"});
  test::expect_words(error(with(R"(<cylinder radius="1" length="0"/>)")),
                     {"'thing'", "cylinder", "length 0"});
  test::expect_words(error(with(R"(<capsule radius="0" length="1"/>)")),
                     {"'thing' collision 1", "capsule", "radius 0"});
  test::expect_words(error(with(R"(<capsule radius="1"/>)")), {"capsule", "length nan"});
  test::expect_words(error(with(R"(<capsule radius="1 1" length="wide"/>)")), {"capsule", "radius nan"});
  test::expect_words(error(with(R"(<cone radius="1" length="1"/>)")), {"thing", "cone"});
  test::expect_words(error(with(R"(<box size="0.1 0.1"/>)")), {"thing"});
  test::expect_words(error(with(R"(<box size="0.1 wide 0.1"/>)")), {"thing", "wide"});
}

TEST(UrdfScene, RefusesJointsThatMakeNoScene) {
  const std::string content = std::string(kInertial) + kBox;
  const std::string two = link("a", content) + link("b", content) + joint("floating", "world", "a");
  test::expect_words(error(robot(link("a", content) + joint("planar", "world", "a"))),
                     {"'world_a'", "planar", "floating", "fixed", "revolute"});
  test::expect_words(error(robot(two + joint("floating", "a", "b"))), {"'a_b'", "floats on 'a'", "'world'"});
  test::expect_words(error(robot(two + joint("fixed", "a", "b"))), {"'a_b'", "free body 'a'", "collision"});
  test::expect_words(error(robot(two)), {"root"});
  test::expect_words(error(robot(two + joint("floating", "world", "c"))), {"c"});
  test::expect_words(error(robot(two + joint("fixed", "world", "b") + joint("fixed", "b", "a"))),
                     {"'a'", "one"});
}

TEST(UrdfScene, RefusesLoopsOfJoints) {
  const std::string loop =
      link("a", kBox) + link("b", kBox) + joint("fixed", "a", "b") + joint("fixed", "b", "a");
  test::expect_words(error(robot(loop)), {"'a'", "loop", "joined to one root link"});
  const std::string beside = link("a", kBox) + link("b", kBox) + joint("fixed", "world", "a");
  test::expect_words(error(robot(beside + joint("fixed", "b", "b"))), {"'b'", "loop"});
  // As many joints as there is room for, none of which ends: in no more than their number's time.
  std::string joints;
  for (int i = 0; i < 20000; ++i) joints += "<joint/>";
  test::expect_words(error(robot(joints)), {"bad URDF"});
  // Not a loop, whatever else is wrong with it.
  EXPECT_EQ(error(robot(beside + joint("fixed", "a", "b") + joint("fixed", "a", "b"))).find("loop"),
            std::string::npos);
}

TEST(UrdfScene, RefusesARootWithGeometry) {
  test::expect_words(error("<robot name=\"x\">" + link("table", kBox) + "</robot>"), {"'table'", "geometry"});
}

TEST(UrdfScene, RefusesNamesThatBreakTablesAndFrames) {
  for (const char* name : {"a,b", "a b", "a/b"}) {
    const std::string urdf =
        robot(link(name, std::string(kInertial) + kBox) + joint("floating", "world", name));
    test::expect_words(error(urdf), {name, "allowed"});
  }
}

}  // namespace
}  // namespace mrhi
