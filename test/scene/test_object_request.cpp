#include "mr_hand_interaction/scene/object_request.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <sstream>

#include "scene_files.h"

namespace mrhi {
namespace {

ObjectRequest primitive(const std::string& shape, const std::vector<double>& size, double mass = 0.2) {
  ObjectRequest request;
  request.name = "thing";
  request.shape = shape;
  request.size = size;
  request.mass = mass;
  return request;
}

ObjectRequest urdf(const std::string& xml) {
  ObjectRequest request;
  request.urdf = xml;
  return request;
}

std::string error_of(const ObjectRequest& request) {
  try {
    requested_body(request, {});
  } catch (const SceneError& error) {
    const std::string message = error.what();
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_EQ(message.find("spawn"), 0u) << message;
    EXPECT_NE(message.find("allowed"), std::string::npos) << message;
    return message;
  }
  return "";
}

TEST(ObjectRequest, primitives_have_the_inertia_of_solids) {
  const Body box = requested_body(primitive("box", {0.1, 0.2, 0.3}), {});
  EXPECT_NEAR(box.inertia(0, 0), 0.2 / 12.0 * (0.04 + 0.09), 1e-15);
  const Body ball = requested_body(primitive("sphere", {0.1}), {});
  EXPECT_NEAR(ball.inertia(1, 1), 0.4 * 0.2 * 0.01, 1e-15);
  const Body rod = requested_body(primitive("cylinder", {0.01, 0.3}), {});
  EXPECT_NEAR(rod.inertia(2, 2), 0.5 * 0.2 * 1e-4, 1e-15);
  EXPECT_NEAR(rod.inertia(0, 0), 0.2 * (3e-4 + 0.09) / 12.0, 1e-15);
  EXPECT_EQ(std::get<Cylinder>(rod.shapes.at(0).shape).half_length, 0.15);
  EXPECT_EQ(rod.visuals.size(), 1u);
  EXPECT_FALSE(rod.fixed);
  const Body pill = requested_body(primitive("capsule", {0.01, 0.3}), {});
  EXPECT_EQ(std::get<Pill>(pill.shapes.at(0).shape).half_length, 0.15);
  EXPECT_GT(pill.inertia(0, 0), rod.inertia(0, 0));
}

TEST(ObjectRequest, without_mass_it_is_a_fixture) {
  EXPECT_TRUE(requested_body(primitive("box", {1, 1, 0.1}, 0.0), {}).fixed);
}

TEST(ObjectRequest, place_motion_material_and_color_are_those_asked_for) {
  ObjectRequest request = primitive("box", {0.1, 0.1, 0.1});
  request.pose = {{1, 2, 3}, Quaternion(0.5, 0.5, 0.5, 0.5)};
  request.twist.linear = {0.1, 0, 0};
  request.material = "{restitution: 0.9}";
  request.rgba = {{1, 0, 0, 1}};
  SceneOptions options;
  options.default_material.static_friction = 0.77;
  const Body body = requested_body(request, options);
  EXPECT_EQ(body.name, "thing");
  EXPECT_EQ(body.start.position, Vector3(1, 2, 3));
  EXPECT_EQ(body.start_twist.linear, Vector3(0.1, 0, 0));
  EXPECT_EQ(body.material.restitution, 0.9);
  EXPECT_TRUE(body.own_material.restitution);
  EXPECT_FALSE(body.own_material.static_friction);
  EXPECT_EQ(body.material.static_friction, 0.77);
  EXPECT_EQ(body.visuals[0].rgba[0], 1.0f);
}

TEST(ObjectRequest, a_urdf_of_one_link_is_free_and_may_be_renamed) {
  const std::string xml =
      "<robot name=\"r\">" + test::link("part", test::kInertial + std::string(test::kBox)) + "</robot>";
  Body body = requested_body(urdf(xml), {});
  EXPECT_EQ(body.name, "part");
  EXPECT_EQ(body.mass, 0.1);
  EXPECT_FALSE(body.fixed);
  ObjectRequest renamed = urdf(xml);
  renamed.name = "other";
  EXPECT_EQ(requested_body(renamed, {}).name, "other");
}

TEST(ObjectRequest, a_urdf_of_a_scene_with_one_link_serves_too) {
  const std::string content = test::kInertial + std::string(test::kBox);
  EXPECT_FALSE(requested_body(urdf(test::thing(content, "xyz=\"1 0 0\"")), {}).fixed);
  const std::string fixture =
      test::robot(test::link("shelf", test::kBox) + test::joint("fixed", "world", "shelf"));
  EXPECT_TRUE(requested_body(urdf(fixture), {}).fixed);
}

TEST(ObjectRequest, a_bad_one_is_refused_with_one_line) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  test::expect_words(error_of(primitive("cone", {1, 1})), {"cone", "box", "capsule"});
  test::expect_words(error_of(primitive("box", {1, 1})), {"2 numbers", "x, y, z"});
  test::expect_words(error_of(primitive("box", {1, -1, 1})), {"-1"});
  test::expect_words(error_of(primitive("sphere", {nan})), {"radius nan"});
  test::expect_words(error_of(primitive("box", {nan, 1, 1})), {"[nan, 1, 1]", "from 1e-05 to 1000 m"});
  test::expect_words(error_of(primitive("box", {1, 1.0 / 0.0, 1})), {"[1, inf, 1]"});
  test::expect_words(error_of(primitive("cylinder", {1e-5, 1000}, 1e-6)),
                     {"principal moments", "the smallest more than 1e-12 of the largest"});
  test::expect_words(error_of(primitive("sphere", {1}, -2.0)), {"-2"});
  for (const double mass : {0.1, 0.0})  // in a file, a shape that small is left out
    test::expect_words(error_of(primitive("sphere", {1e-6}, mass)), {"radius 1e-06 m", "from 1e-05"});
  ObjectRequest bad = primitive("sphere", {0.1});
  bad.name = "a b";
  test::expect_words(error_of(bad), {"name"});
  bad = primitive("sphere", {0.1});
  bad.pose.position.x() = nan;
  test::expect_words(error_of(bad), {"position [nan, 0, 0]"});
  bad = primitive("sphere", {0.1});
  bad.pose.orientation.coeffs().setZero();
  test::expect_words(error_of(bad), {"orientation [0, 0, 0, 0]"});
  for (const bool turns : {false, true}) {
    bad = primitive("sphere", {0.1});
    (turns ? bad.twist.angular : bad.twist.linear).y() = nan;
    test::expect_words(error_of(bad), {"velocity [", "nan", "finite"});
  }
  bad = primitive("sphere", {0.1});
  bad.material = "{dynamic_friction: 3}";
  test::expect_words(error_of(bad), {"dynamic_friction"});
  test::expect_words(error_of(urdf("<robot")), {"URDF"});
  test::expect_words(error_of(urdf("<robot name=\"r\"><link name=\"a\"/></robot>")), {"no link"});
  const std::string two = test::robot(test::link("a", test::kBox) + test::joint("fixed", "world", "a") +
                                      test::link("b", test::kBox) + test::joint("fixed", "world", "b"));
  test::expect_words(error_of(urdf(two)), {"several"});
  const std::string door = test::link("door", test::kInertial + std::string(test::kBox));
  test::expect_words(error_of(urdf(test::robot(door + test::joint("continuous", "world", "door")))),
                     {"turns or slides", "floating, fixed"});
}

TEST(ObjectRequest, a_file_that_is_no_urdf_is_refused_by_its_path_without_its_text) {
  const test::Folder folder;
  const std::string file = folder.write("thing.urdf", "root:x:0:0:root\nsecret");
  for (const std::string scheme : {"", "file://"}) {
    const std::string refusal = error_of(urdf(scheme + file));
    test::expect_words(refusal, {"no URDF in '" + scheme + file + "'", "absolute path"});
    EXPECT_EQ(refusal.find("secret"), std::string::npos) << refusal;
  }
}

TEST(ObjectRequest, of_a_urdf_whose_only_shape_is_left_out_is_refused) {
  const std::string speck = "<collision><geometry><sphere radius=\"1e-6\"/></geometry></collision>";
  for (const std::string mass : {"", test::kInertial})
    test::expect_words(error_of(urdf("<robot name=\"r\">" + test::link("a", mass + speck) + "</robot>")),
                       {"link 'a'", "no collision with a volume"});
}

TEST(ObjectRequest, a_whole_scene_whose_bodies_begin_inside_each_other_is_refused_with_their_names) {
  const std::string content = test::kInertial + std::string(test::kBox);
  const auto two = [&](const std::string& apart) {
    ObjectRequest request =
        urdf(test::robot(test::link("one", content) + test::joint("floating", "world", "one") +
                         test::link("other", content) + test::joint("floating", "world", "other", apart)));
    request.whole = true;
    return request;
  };
  EXPECT_EQ(requested_scene(two("xyz=\"1 0 0\""), {}).bodies.size(), 2u);
  try {
    requested_scene(two("xyz=\"0.01 0 0\""), {});
    FAIL() << "it was taken";
  } catch (const SceneError& refusal) {
    test::expect_words(refusal.what(), {"spawn", "'one'", "'other'", "0.001 m"});
  }
}

TEST(ObjectRequest, a_colour_has_parts_from_0_to_1_and_no_others) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  for (const std::array<float, 4>& rgba : {std::array<float, 4>{{nan, 0, 0, 1}},
                                           {{0, 1e30f, 0, 1}},
                                           {{0, 0, -5, 1}},
                                           {{0, 0, 0, nan}},
                                           {{0, 0, 0, 1.5f}}}) {
    ObjectRequest request = primitive("box", {0.1, 0.1, 0.1});
    request.rgba = rgba;
    test::expect_words(error_of(request), {"color [", "opacity, each a number from 0 to 1"});
    std::ostringstream given;
    given << '"' << rgba[0] << ' ' << rgba[1] << ' ' << rgba[2] << ' ' << rgba[3] << '"';
    const std::string link =
        std::string(test::kInertial) + test::kBox +
        "<visual><geometry><box size=\"1 1 1\"/></geometry><material name=\"m\"><color rgba=" + given.str() +
        "/></material></visual>";
    EXPECT_NE(error_of(urdf("<robot name=\"r\">" + test::link("part", link) + "</robot>")), "")
        << given.str();
  }
  ObjectRequest request = primitive("box", {0.1, 0.1, 0.1});
  request.rgba = {{0, 1, 0.5f, 1}};
  EXPECT_EQ(error_of(request), "");
}

TEST(ObjectRequest, joints_for_a_urdf_without_any_are_refused_with_the_reason) {
  ObjectRequest request = urdf(test::robot(test::link("one", test::kInertial + std::string(test::kBox)) +
                                           test::joint("floating", "world", "one")));
  request.whole = true;
  for (const char* joints : {"5", "{x: 1}", "[1]"}) {
    request.joints = joints;
    try {
      requested_scene(request, {});
      FAIL() << joints;
    } catch (const SceneError& refusal) {
      test::expect_words(refusal.what(), {"joints", "allowed: nothing: this URDF has no joints"});
    }
  }
  request.joints = "{}";
  EXPECT_EQ(requested_scene(request, {}).bodies.size(), 1u);
}

}  // namespace
}  // namespace mrhi
