#include <gtest/gtest.h>

#include "mr_hand_interaction/simulation.h"
#include "scene/scene_files.h"
#include "support/fixtures.h"

namespace mrhi {
namespace {

using test::urdf_error;

/// A free body of a 5 cm box at that place.
std::string box_at(const std::string& name, const std::string& origin) {
  return test::link(name, test::kInertial + std::string(test::kBox)) +
         test::joint("floating", "world", name, "xyz=\"" + origin + "\"");
}

TEST(Overlaps, of_bodies_at_load_are_refused_and_named) {
  EXPECT_EQ(urdf_error(test::robot(box_at("a", "0 0 0") + box_at("b", "0.05 0 0"))), "") << "they touch";
  EXPECT_EQ(urdf_error(test::robot(box_at("a", "0 0 0") + box_at("b", "0.0495 0 0"))), "") << "half a mm";
  test::expect_words(urdf_error(test::robot(box_at("a", "0 0 0") + box_at("b", "0.04 0 0"))),
                     {"'b' is 0.01 m in 'a'", "at most 0.001 m"});
  std::string boxes;
  for (int i = 0; i < 14; ++i) boxes += box_at("box" + std::to_string(i), "0 0 " + std::to_string(0.001 * i));
  const std::string message = urdf_error(test::robot(boxes));
  test::expect_words(message, {"'box1' is ", " m in 'box0'"});
  EXPECT_LT(message.size(), 600u);
}

// Half of a millimetre would give each 9 cm/s. What is left is below 0.1 um.
TEST(Overlaps, of_less_than_a_millimetre_are_parted_at_load_and_set_nothing_in_motion) {
  const test::Folder folder;
  std::string boxes = box_at("far", "0 0 0.5") +
                      test::link("shelf", test::kInertial + std::string(test::kBox)) +
                      test::joint("fixed", "world", "shelf", "xyz=\"0 0 0.0495\"");
  for (int i = 0; i < 8; ++i) boxes += box_at("box" + std::to_string(i), std::to_string(0.0495 * i) + " 0 0");
  const Scene scene = load_scene(folder.write("s.urdf", test::robot(boxes)), {});
  ASSERT_EQ(scene.warnings.size(), 1u);
  test::expect_words(scene.warnings[0], {"moved apart", "'box0' by 0.00", "more"});
  Simulation simulation(scene, testing::unfiltered(ContactModelKind::implicit));
  for (int i = 0; i <= 60; ++i) simulation.advance({testing::at(i / 60.0), {}});
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    const Vector3 moved = simulation.state().bodies[b].pose.position - scene.bodies[b].start.position;
    EXPECT_LT(moved.norm(), 1e-4) << scene.bodies[b].name;
  }
}

// Faces that coincide have no corner within the other mesh: what they share is found by its volume.
TEST(Overlaps, of_meshes_inside_each_other_are_refused_whatever_coincides) {
  const test::Folder folder;
  // Half the thickness is that of the mesh; it is 6 cm wide [m].
  const auto mesh_of = [&](const std::string& name, double half) {
    std::string text = "";
    for (int i = 0; i < 8; ++i)
      text += "v " + std::to_string(i & 1 ? 0.03 : -0.03) + " " + std::to_string(i & 2 ? 0.03 : -0.03) + " " +
              std::to_string(i & 4 ? half : -half) + "\n";
    folder.write(name, text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n");
    return test::kInertial +
           ("<collision><geometry><mesh filename=\"" + name + "\"/></geometry></collision>");
  };
  const std::string mesh = mesh_of("cube.obj", 0.03), plate = mesh_of("plate.obj", 0.0004);
  const auto error = [&](const std::string& other, const std::string& place, const std::string& first) {
    return test::scene_error(folder.write(
        "s.urdf",
        test::robot(test::link("a", first) + test::joint("floating", "world", "a") + test::link("b", other) +
                    test::joint("floating", "world", "b", "xyz=\"" + place + "\""))));
  };
  for (const char* place :
       {"0 0 0", "0.001 0 0", "0 0.03 0", "0 0 0.0585", "0.03 0.03 0", "0.02 -0.01 0.005"})
    test::expect_words(error(mesh, place, mesh), {"'b'", "'a'", "at most 0.001 m"});
  for (const char* place : {"0.0595 0 0", "0 0.06 0", "0.06 0.06 0", "0 0 0.07"})
    EXPECT_EQ(error(mesh, place, mesh), "") << place;
  const std::string box =
      test::kInertial +
      std::string("<collision><geometry><box size=\"0.06 0.06 0.06\"/></geometry></collision>");
  test::expect_words(error(box, "0.03 0 0", mesh), {"'b'", "'a'"});
  EXPECT_EQ(error(box, "0.06 0 0", mesh), "");
  // No ball of 1 mm fits in what a box shares with a thin plate: corners of the plate are too deep.
  test::expect_words(error(box, "0.05 0.01 0", plate), {"'b'", "'a'", "at most 0.001 m"});
}

// No ball of 1 mm fits in a wall of 0.9 mm.
TEST(Overlaps, of_thin_walls_in_one_place_are_refused_and_walls_that_touch_are_not) {
  const test::Folder folder;
  std::string text;
  for (int i = 0; i < 8; ++i)
    text += std::string("v ") + (i & 1 ? "0.03 " : "-0.03 ") + (i & 2 ? "0.03 " : "-0.03 ") +
            (i & 4 ? "0.00045\n" : "-0.00045\n");
  const std::string closed = "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n";
  folder.write("wall.obj", text + closed);
  const auto error = [&](const std::string& file, const std::string& place) {
    const std::string mesh =
        test::kInertial + ("<collision><geometry><mesh filename=\"" + file + "\"/></geometry></collision>");
    return test::scene_error(folder.write(
        "s.urdf",
        test::robot(test::link("a", mesh) + test::joint("floating", "world", "a") + test::link("b", mesh) +
                    test::joint("floating", "world", "b", "xyz=\"" + place + "\""))));
  };
  for (const char* place : {"0 0 0", "0.0002 0 0", "0 0.0003 0.0002"})
    test::expect_words(error("wall.obj", place),
                       {"'b' is inside thin walls of 'a'", "allowed: at most 0.001 m"});
  for (const char* place : {"0 0 0.0009", "0 0 0.0008", "0.06 0 0", "0.0599 0 0", "0 0 0.01"})
    EXPECT_EQ(error("wall.obj", place), "") << place;
}

// Shapes thinner than 1 mm are never 1 mm deep in each other.
TEST(Overlaps, of_thin_shapes_that_cross_or_hold_each_other_are_refused) {
  const auto shape = [](const std::string& geometry) {
    return test::kInertial + ("<collision><geometry>" + geometry + "</geometry></collision>");
  };
  const auto error = [&](const std::string& one, const std::string& other, const std::string& origin) {
    return urdf_error(test::robot(test::link("a", shape(one)) + test::joint("floating", "world", "a") +
                                  test::link("b", shape(other)) +
                                  test::joint("floating", "world", "b", origin)));
  };
  const std::string slab = "<box size=\"0.06 0.06 0.0005\"/>",
                    disc = "<cylinder radius=\"0.03\" length=\"0.0005\"/>",
                    bead = "<sphere radius=\"0.0005\"/>", block = "<box size=\"0.06 0.06 0.06\"/>";
  const struct {
    std::string one, other, in, beside;
  } cases[] = {
      {slab, slab, "xyz=\"0 0 0\"", "xyz=\"0 0 0.0004\""},
      {slab, slab, "xyz=\"0.01 0 0\" rpy=\"1.57 0 0\"", "xyz=\"0 0 0.0302\" rpy=\"1.57 0 0\""},
      {disc, slab, "xyz=\"0 0 0.01\" rpy=\"0 0.7 0\"", "xyz=\"0 0 0.0005\""},
      {bead, bead, "xyz=\"0 0.0004 0\"", "xyz=\"0 0.0009 0\""},
      {bead, slab, "xyz=\"0.01 0.01 0\"", "xyz=\"0.01 0.01 0.0007\""},
      {block, slab, "xyz=\"0 0 0.0294\"", "xyz=\"0 0 0.03\""},
  };
  for (const auto& c : cases) {
    test::expect_words(error(c.one, c.other, c.in),
                       {"'b' is inside thin walls of 'a'", "allowed: at most 0.001 m"});
    EXPECT_EQ(error(c.one, c.other, c.beside), "") << c.other << " " << c.beside;
  }
}

TEST(Overlaps, of_fixtures_with_each_other_are_their_own_affair) {
  const std::string shelf = test::link("s", test::kBox) + test::joint("fixed", "world", "s") +
                            test::link("t", test::kBox) + test::joint("fixed", "world", "t");
  EXPECT_EQ(urdf_error(test::robot(shelf)), "");
  test::expect_words(urdf_error(test::robot(shelf + box_at("a", "0 0 0.03"))), {"'a' is 0.02 m in 's'"});
}

}  // namespace
}  // namespace mrhi
