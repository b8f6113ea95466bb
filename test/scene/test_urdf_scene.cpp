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
  const Scene grey = load(robot(link("a", kBox + visual) + joint("fixed", "world", "a")));
  EXPECT_EQ(Visual().rgba, grey.bodies.at(0).visuals.at(0).rgba);
  test::expect_words(grey.warnings.at(0), {"'a'", "'blue'"});
}

TEST(UrdfScene, WhatHasNoVisualIsSeenByItsCollisionShapes) {
  const Scene scene = load(thing(std::string(kInertial) + kBox));
  ASSERT_EQ(1u, scene.bodies.at(0).visuals.size());
  EXPECT_TRUE(std::holds_alternative<Box>(scene.bodies[0].visuals[0].shape));
}

TEST(UrdfScene, RefusesWhatIsNoUrdf) {
  test::expect_words(error(""), {"this file is empty"});
  test::expect_words(error("<robot name=\"x\"><link name=\"a\"></robot>"), {"bad URDF"});
  test::expect_words(error("gravity: [0, 0, 0]"), {"bad URDF"});
  test::expect_words(error("<robot name=\"x\"><link name=\"a\"/><link name=\"a\"/></robot>"),
                     {"'a'", "unique"});
  test::expect_words(error(robot("")), {"no bodies"});
  test::expect_words(test::scene_error("nowhere/none.urdf"), {"none.urdf", "cannot be read"});
}

TEST(UrdfScene, RefusesAWrongMass) {
  for (const char* mass : {"1e-09", "-0.1"}) {
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

// As 1000 URDFs that PyBullet comes with, and files that give some of the moments alone.
TEST(UrdfScene, AnInertiaThatLacksAMomentIsThatOfTheShapes) {
  for (const char* given : {R"(ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="0")", R"(ixx="1e-4")"}) {
    const Scene scene =
        load(thing("<inertial><mass value=\"0.6\"/><inertia " + std::string(given) + "/></inertial>" + kBox));
    const Matrix3 expected = 0.6 * 0.0025 / 6.0 * Matrix3::Identity();
    EXPECT_TRUE(scene.bodies.at(0).inertia.isApprox(expected, 1e-12)) << given;
    test::expect_words(scene.warnings.at(0), {"lack a moment", "'thing' [0, "});
  }
}

TEST(UrdfScene, ElementsWithoutAShapeAreLeftOut) {
  const Scene scene = load(thing(std::string(kInertial) + kBox +
                                 "<collision/><visual><geometry/><origin xyz=\"0 0 1\"/></visual>"));
  EXPECT_EQ(1u, scene.bodies.at(0).shapes.size());
  test::expect_words(scene.warnings.at(0), {"without a shape", "'thing' visual", "'thing' collision"});
}

TEST(UrdfScene, VectorsOfMoreThanThreeNumbersAreReadByTheFirstThree) {
  const Scene scene = load(thing(std::string(kInertial) +
                                     R"(<collision><origin xyz="0.1 0.2 0.3 1"/>
                                        <geometry><box size="1 2 3 4"/></geometry></collision>)",
                                 R"(xyz="0 0 0.5" rpy="0 0 0 0")"));
  EXPECT_TRUE(
      std::get<Box>(scene.bodies.at(0).shapes.at(0).shape).half_extents.isApprox(Vector3(0.5, 1, 1.5)));
  test::expect_words(scene.warnings.at(0), {"the first three", "link 'thing' collision xyz '0.1 0.2 0.3 1'",
                                            "size '1 2 3 4'", "rpy"});
}

// Drake marks places of contact with balls of 0.1 um.
TEST(UrdfScene, ShapesTooSmallToTouchAreLeftOut) {
  const Scene scene = load(thing(std::string(kInertial) + kBox +
                                 R"(<collision><geometry><sphere radius="1e-7"/></geometry></collision>)"));
  EXPECT_EQ(1u, scene.bodies.at(0).shapes.size());
  test::expect_words(scene.warnings.at(0), {"smaller than 1e-05 m", "'thing' collision 2"});
}

TEST(UrdfScene, RefusesAFreeBodyWithoutCollisionUnlessItHasAVisual) {
  const Scene seen =
      load(thing(std::string(kInertial) + R"(<visual><geometry><sphere radius="0.1"/></geometry></visual>)"));
  EXPECT_TRUE(std::holds_alternative<Sphere>(seen.bodies.at(0).shapes.at(0).shape));
  test::expect_words(seen.warnings.at(0), {"'thing'", "visuals"});
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
  const Scene floating = load(robot(two + joint("floating", "a", "b", R"(xyz="0.3 0 0")")));
  EXPECT_EQ(2u, floating.bodies.size()) << "free of what it is placed by";
  test::expect_words(error(robot(two)), {"root"});
  test::expect_words(error(robot(two + joint("floating", "world", "c"))), {"c"});
  test::expect_words(error(robot(two + joint("fixed", "world", "b") + joint("fixed", "b", "a"))),
                     {"'a'", "one"});
}

TEST(UrdfScene, RefusesLoopsOfJoints) {
  const std::string loop =
      link("a", kBox) + link("b", kBox) + joint("fixed", "a", "b") + joint("fixed", "b", "a");
  test::expect_words(error(robot(loop)), {"'a'", "loop", "a tree of links"});
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

const char* const kBall = R"(<collision><geometry><sphere radius="0.02"/></geometry></collision>)";

TEST(UrdfScene, ARootWithAShapeIsAFreeBodyUnlessItIsTheWorldOrWeighsNothing) {
  const auto root = [](const std::string& name, const std::string& content) {
    return load("<robot name=\"x\">" + link(name, content) + "</robot>");
  };
  const Scene cup = root("cup", std::string(kInertial) + kBox);
  ASSERT_EQ(1u, cup.bodies.size());
  EXPECT_FALSE(cup.bodies[0].fixed);
  EXPECT_TRUE(cup.bodies[0].start.position.isZero());
  EXPECT_TRUE(cup.warnings.empty());
  EXPECT_TRUE(root("world", kBox).bodies.at(0).fixed);
  const Scene plane = root("plane", inertial("0", {0, 0, 0}) + kBox);
  EXPECT_TRUE(plane.bodies.at(0).fixed);
  test::expect_words(plane.warnings.at(0), {"'plane'", "mass 0", "fixtures"});
  // A joint's parent may be a world that is no link of the file.
  EXPECT_TRUE(load("<robot name=\"x\">" + link("a", kBox) + joint("fixed", "world", "a") + "</robot>")
                  .bodies.at(0)
                  .fixed);
}

// 0.1 kg at 0 and 0.3 kg at x = 0.08: the centre is at 0.06. Of two balls of 0.4 m r^2 each,
// I_xx = 0.4 (0.1 + 0.3) 0.02^2, and I_yy has 0.1 0.06^2 + 0.3 0.02^2 besides.
TEST(UrdfScene, LinksOnFixedJointsAreOneBodyWithTheMassCentreAndInertiaOfAll) {
  const auto ball = [](const std::string& mass) {
    return "<inertial><mass value=\"" + mass + "\"/></inertial>" + kBall;
  };
  const Scene scene =
      load(robot(link("cup", ball("0.1")) + link("frame", "") + link("handle", ball("0.3")) +
                 link("lid", kBall) + joint("floating", "world", "cup", R"(xyz="0 0 0.2")") +
                 joint("fixed", "cup", "frame", R"(xyz="0 0.08 0" rpy="0 0 -1.5707963267948966")") +
                 joint("fixed", "frame", "handle", R"(xyz="0.08 0.08 0" rpy="0 0 1.5707963267948966")") +
                 joint("fixed", "cup", "lid", R"(xyz="0 0 0.1")")));
  ASSERT_EQ(1u, scene.bodies.size());
  const Body& body = scene.bodies[0];
  EXPECT_EQ("cup", body.name);
  EXPECT_NEAR(0.4, body.mass, 1e-15);
  EXPECT_TRUE(body.start.position.isApprox(Vector3(0.06, 0, 0.2), 1e-12)) << body.start.position.transpose();
  ASSERT_EQ(3u, body.shapes.size());
  EXPECT_TRUE(body.shapes[1].pose.position.isApprox(Vector3(0.02, 0, 0), 1e-12));
  EXPECT_TRUE(body.shapes[2].pose.position.isApprox(Vector3(-0.06, 0, 0.1), 1e-12)) << "no mass, but a shape";
  EXPECT_NEAR(0.4 * 0.4 * 4e-4, body.inertia(0, 0), 1e-12);
  EXPECT_NEAR(0.4 * 0.4 * 4e-4 + 0.1 * 0.0036 + 0.3 * 0.0004, body.inertia(1, 1), 1e-12);
}

TEST(UrdfScene, ABodyWithoutMassHasThatOfItsVolumeAndItIsSaid) {
  SceneOptions options;
  options.density = 500.0;
  const test::Folder folder;
  const std::string file = folder.write(
      "t.urdf",
      thing(std::string(kBox) + R"(<collision><origin xyz="0.05 0 0"/><geometry><box size="0.05 0.05 0.05"/>
                      </geometry></collision>)"));
  const Scene scene = load_scene(file, options);
  EXPECT_NEAR(500.0 * 2 * 1.25e-4, scene.bodies.at(0).mass, 1e-12);
  EXPECT_TRUE(scene.bodies[0].start.position.isApprox(Vector3(0.025, 0, 0), 1e-12));
  EXPECT_NEAR(0.125 * (0.0025 + 0.01) / 12.0, scene.bodies[0].inertia(1, 1), 1e-12);
  ASSERT_EQ(1u, scene.warnings.size());
  test::expect_words(scene.warnings[0], {"scene/density", "500 kg/m^3", "'thing' 0.125 kg"});
}

// 1e-2: what shapes share is measured along lines, of round ones between facets.
TEST(UrdfScene, WhatShapesShareCountsOnce) {
  const Scene scene = load(thing(std::string(kBox) + kBall));  // the ball is in the box
  EXPECT_NEAR(0.125, scene.bodies.at(0).mass, 1e-2 * 0.125);
  EXPECT_NEAR(0.125 * 2 * 0.0025 / 12.0, scene.bodies[0].inertia(0, 0), 1e-2 * 5.2e-5);
}

TEST(UrdfScene, LimitsThatAreNotWholeAreCompletedAndThatIsSaid) {
  const auto door = [](const std::string& type, const std::string& more) {
    return load(robot(link("door", std::string(kInertial) + kBox) + "<joint name=\"j\" type=\"" + type +
                      "\"><parent link=\"world\"/><child link=\"door\"/><axis xyz=\"0 0 1\"/>" + more +
                      "</joint>"));
  };
  const Scene bare = door("prismatic", R"(<limit lower="0" upper="0.2"/>)");
  EXPECT_EQ(0.2, bare.joints.at(0).upper);
  EXPECT_TRUE(bare.warnings.empty());
  const Scene none = door("revolute", "");
  EXPECT_FALSE(none.joints.at(0).is_limited());
  test::expect_words(none.warnings.at(0), {"without limits", "'j'"});
  test::expect_words(door("revolute", R"(<limit lower="1" upper="0"/>)").warnings.at(0),
                     {"'j'", "lower 1 above upper 0"});
  const Scene equal = door("revolute", R"(<limit lower="0" upper="0"/>)");
  EXPECT_TRUE(equal.joints.empty() && equal.bodies.at(0).fixed);
  test::expect_words(equal.warnings.at(0), {"equal limits", "'j'"});
  for (const char* far : {R"(lower="-inf" upper="inf")", R"(lower="-1e9" upper="1e16")"}) {
    const Joint free = door("revolute", "<limit " + std::string(far) + "/>").joints.at(0);
    EXPECT_EQ(-1000, free.lower);
    EXPECT_EQ(1000, free.upper);
  }
  const Scene mimic = door("continuous", R"(<mimic joint="other"/>)");
  EXPECT_EQ(1u, mimic.joints.size());
  test::expect_words(mimic.warnings.at(0), {"<mimic>", "'j'"});
}

TEST(UrdfScene, LinksFixedOnAnEmptyRootAreOneFreeBodyUnlessTheRootIsTheWorld) {
  const std::string cup = link("cup", std::string(kInertial) + kBox) +
                          link("handle", std::string(kInertial) + kBox) + joint("fixed", "base", "cup") +
                          joint("fixed", "cup", "handle", R"(xyz="0.1 0 0")");
  const Scene scene = load("<robot name=\"t\"><link name=\"base\"/>" + cup + "</robot>");
  ASSERT_EQ(1u, scene.bodies.size());
  EXPECT_FALSE(scene.bodies[0].fixed);
  EXPECT_NEAR(0.2, scene.bodies[0].mass, 1e-12);
  test::expect_words(scene.warnings.at(0), {"one free body", "'world'", "'base'"});
  const std::string door =
      link("door", std::string(kInertial) + kBox) + joint("revolute", "base", "door", R"(xyz="0 1 0")");
  EXPECT_TRUE(load("<robot name=\"t\"><link name=\"base\"/>" + cup + door + "</robot>").bodies[0].fixed)
      << "what something moves on stands still";
}

TEST(UrdfScene, IsReadFromUtf16AsWindowsWritesIt) {
  const std::string text = robot(link("thing", std::string(kInertial) + kBox) +
                                 joint("floating", "world", "thing") + "<!-- \xC3\xBC \xF0\x9F\xA7\xAA -->");
  const std::u16string wide = u"<!-- \u00FC \U0001F9EA -->";
  for (const bool little : {true, false}) {
    std::string bytes = little ? "\xFF\xFE" : "\xFE\xFF";
    const auto put = [&](char16_t unit) {
      const char low = static_cast<char>(unit & 0xFF), high = static_cast<char>(unit >> 8);
      bytes += little ? low : high, bytes += little ? high : low;
    };
    for (const char c : text.substr(0, text.find("<!--"))) put(static_cast<char16_t>(c));
    for (const char16_t unit : wide) put(unit);
    for (const char c : std::string("</robot>")) put(static_cast<char16_t>(c));
    EXPECT_EQ("thing", load(bytes).bodies.at(0).name);
  }
}

TEST(UrdfScene, MayHaveACommentAboveItsDeclaration) {
  EXPECT_EQ("",
            error("<!-- who made it -->\n<?xml version=\"1.0\"?>\n" + thing(std::string(kInertial) + kBox)));
}

TEST(UrdfScene, ColoursOfOtherRangesAreBroughtIntoOurs) {
  const auto color = [](const std::string& rgba) {
    const Scene scene = load(thing(std::string(kInertial) + kBox +
                                   "<visual><geometry><sphere radius=\"1\"/></geometry><material "
                                   "name=\"m\"><color rgba=\"" +
                                   rgba + "\"/></material></visual>"));
    return std::make_pair(scene.bodies.at(0).visuals.at(0).rgba, scene.warnings.size());
  };
  EXPECT_EQ(std::make_pair((std::array<float, 4>{{1.0f, 0.2f, 0.0f, 1.0f}}), std::size_t(1)),
            color("255 51 0 255"));
  EXPECT_EQ(std::make_pair((std::array<float, 4>{{1.0f, 0.2f, 0.0f, 0.5f}}), std::size_t(1)),
            color("255 51 0 0.5"));
  EXPECT_EQ(std::make_pair((std::array<float, 4>{{1.0f, 0.2f, 0.0f, 1.0f}}), std::size_t(0)),
            color("1.00001 0.2 0 1"));
  EXPECT_EQ(std::make_pair((std::array<float, 4>{{0.7f, 0.7f, 0.7f, 1.0f}}), std::size_t(1)),
            color("#ff0000"));
}

TEST(UrdfScene, FrictionOfOtherSimulatorsTagsIsRead) {
  const std::string contact = R"(<contact><lateral_friction value="1.5"/></contact>)";
  const Scene scene =
      load(robot(link("a", contact + kInertial + kBox) + link("b", std::string(kInertial) + kBox) +
                 joint("floating", "world", "a") + joint("floating", "world", "b", R"(xyz="1 0 0")") +
                 R"(<gazebo reference="b"><mu1>0.25</mu1></gazebo>)"));
  EXPECT_EQ(1.5, scene.bodies.at(0).material.static_friction);
  EXPECT_EQ(1.5, scene.bodies.at(0).material.dynamic_friction);
  EXPECT_EQ(0.25, scene.bodies.at(1).material.dynamic_friction);
  EXPECT_TRUE(scene.bodies.at(1).own_material.static_friction);
  EXPECT_FALSE(scene.bodies.at(1).own_material.restitution);
  const auto friction = [](const std::string& in_link, const std::string& behind) {
    return load(robot(link("a", in_link + kInertial + kBox) + joint("floating", "world", "a") + behind))
        .bodies.at(0)
        .material.static_friction;
  };
  EXPECT_EQ(0.6, friction("<contact><lateral_friction> 0.6 </lateral_friction></contact>", ""));
  EXPECT_EQ(0.6, friction("<contact><drake:mu_static value=\"0.6\"/></contact>", ""));
  EXPECT_EQ(0.6, friction("", R"(<gazebo reference="a"><collision><surface><friction><ode><mu>0.6</mu></ode>
                                 </friction></surface></collision></gazebo>)"));
  EXPECT_EQ(0.6, friction("", R"(<gazebo reference="a"><mu1 value="0.6"/></gazebo>)"));
  EXPECT_EQ(0.6, friction("<contact><contact_coefficients mu=\"0.6\" kp=\"1000\"/></contact>", ""));
  EXPECT_EQ(0.8, friction("<contact_coefficients mu=\"0\" kp=\"1000.0\" kd=\"1.0\"/>", ""))
      << "a placeholder";
  EXPECT_EQ(
      0.6,
      friction("<collision><surface><friction><ode><mu>0.6</mu></ode></friction></surface></collision>", ""));
}

TEST(UrdfScene, WarnsOfUnitsThatCannotBeMeant) {
  const auto warning = [](const std::string& content) { return load(thing(content)).warnings.at(0); };
  test::expect_words(warning(inertial("0.1", {1, 1, 1}) + kBox), {"'thing' 1 kg m^2", "unit"});
  test::expect_words(warning(std::string(inertial("0.1", {1, 1, 1})) +
                             R"(<collision><geometry><box size="90 90 90"/></geometry></collision>)"),
                     {"millimetres", "'thing'"});
  test::expect_words(load(thing(std::string(kInertial) + kBox, R"(rpy="0 90 0")")).warnings.at(0),
                     {"radians", "0 90 0"});
  test::expect_words(warning(inertial("2", {1e-6, 1e-6, 1e-6}) + kBox), {"'thing'", "unit"});
  test::expect_words(
      warning("<inertial><mass value=\"0.01\"/></inertial><collision><geometry><box size=\"5e-5 "
              "5e-5 5e-5\"/></geometry></collision>"),
      {"very small", "'thing' measures 5e-05 m"});
  const auto of_mass = [](const std::string& mass) {
    return thing("<inertial><mass value=\"" + mass + "\"/></inertial>" + kBox);
  };
  test::expect_words(load(of_mass("150")).warnings.at(0), {"grams", "'thing' 150 kg"});
  test::expect_words(load(of_mass("3.2")).warnings.at(0), {"grams", "'thing' 3.2 kg"});
  EXPECT_TRUE(load(of_mass("3.0")).warnings.empty()) << "osmium is denser than most";
}

// A mug whose file has a mass alone: its centre would be in its bottom.
TEST(UrdfScene, WarnsOfACentreOfMassThatIsNotInsideTheShapes) {
  const auto warnings = [](const std::string& origin) {
    return load(thing("<inertial>" + origin +
                      "<mass value=\"0.1\"/></inertial><collision><origin xyz=\"0 0 " +
                      "0.025\"/><geometry><box size=\"0.05 0.05 0.05\"/></geometry></collision>"))
        .warnings;
  };
  test::expect_words(warnings("").at(0),
                     {"centres of mass", "'thing' [0, 0, 0] m, the middle is [0, 0, 0.025] m"});
  test::expect_words(warnings(R"(<origin xyz="0 0 25"/>)").at(0), {"centres of mass", "in metres"});
  EXPECT_TRUE(warnings(R"(<origin xyz="0 0 0.01"/>)").empty()) << "a heavy bottom";
}

TEST(UrdfScene, BoundsThatNoFileGivesHoldTheStarts) {
  const std::string far = thing(std::string(kInertial) + kBox, R"(xyz="5 0 0")");
  const Scene scene = load(far);
  EXPECT_GT(scene.bounds.max.x(), 5.5);
  test::expect_words(scene.warnings.at(0), {"bounds"});
  const test::Folder folder;
  folder.write("t.yaml", "bounds: {min: [-1, -1, -1], max: [1, 1, 1]}\n");
  test::expect_words(test::scene_error(folder.write("t.urdf", far)), {"'thing'", "out of bounds"});
}

TEST(UrdfScene, NamesOtherFormatsThatAreNoUrdf) {
  test::expect_words(error("<sdf version=\"1.6\"/>"), {"is SDF", "URDF"});
  test::expect_words(error(thing(std::string(kInertial) +
                                 R"(<collision><geometry><box size="${w} 1 1"/></geometry></collision>)")),
                     {"is xacro", "rosrun xacro"});
  EXPECT_EQ("", error(thing(std::string(kInertial) + kBox +
                            R"(<xacro:property name="w"><origin xyz="${w} 0 0"/></xacro:property>)")))
      << "nothing uses it";
  test::expect_words(error("<mujoco/>"), {"'robot'", "'mujoco'"});
}

}  // namespace
}  // namespace mrhi
