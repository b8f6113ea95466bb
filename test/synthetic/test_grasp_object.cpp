#include <gtest/gtest.h>

#include "mr_hand_interaction/simulation.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "scene/scene_files.h"
#include "synthetic/performance.h"

namespace mrhi {
namespace {

/// One free object of shapes, or of a mesh, turned by `rpy`.
struct Object {
  const char* name;
  std::string collisions;
  const char* rpy = "0 0 0";
  std::string obj = "";
};

/// Writes solids of revolution and bent rods as an OBJ file.
class Model {
 public:
  /// About z, through points (radius, z): from the axis to the axis, or a closed ring.
  Model& lathe(const std::vector<std::array<double, 2>>& profile) {
    constexpr int kAround = 48;
    std::vector<std::vector<int>> rows;
    for (const auto& [radius, z] : profile) {
      rows.emplace_back();
      for (int k = 0; k < kAround; ++k) {
        const double angle = 2.0 * M_PI * k / kAround;
        const bool again = radius == 0.0 && k > 0;
        rows.back().push_back(again ? rows.back()[0]
                                    : vertex({radius * std::cos(angle), radius * std::sin(angle), z}));
      }
    }
    const bool is_ring = profile.front()[0] != 0.0;
    for (std::size_t i = 0; i + (is_ring ? 0 : 1) < rows.size(); ++i)
      join(rows[i], rows[(i + 1) % rows.size()]);
    return *this;
  }
  /// A rod along a path in the xz plane, with a radius for each point.
  Model& rod(const std::vector<Vector3>& path, const std::vector<double>& radii) {
    constexpr int kAround = 16;
    std::vector<int> before;
    for (std::size_t i = 0; i < path.size(); ++i) {
      const Vector3 along = (path[std::min(i + 1, path.size() - 1)] - path[i > 0 ? i - 1 : 0]).normalized(),
                    side = along.cross(Vector3::UnitY());
      std::vector<int> row;
      for (int k = 0; k < kAround; ++k) {
        const double angle = 2.0 * M_PI * k / kAround;
        row.push_back(
            vertex(path[i] + radii[i] * (std::cos(angle) * side + std::sin(angle) * Vector3::UnitY())));
      }
      const std::vector<int> end(kAround, i == 0 || i + 1 == path.size() ? vertex(path[i]) : 0);
      join(i == 0 ? end : before, row);
      if (i + 1 == path.size()) join(row, end);
      before = row;
    }
    return *this;
  }
  std::string obj() const { return vertices_ + faces_; }

 private:
  int vertex(const Vector3& at) {
    vertices_ += "v";
    for (int i = 0; i < 3; ++i) vertices_ += " " + std::to_string(at[i]);
    vertices_ += "\n";
    return ++count_;
  }
  void face(int a, int b, int c) {
    faces_ += "f " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  }
  void join(const std::vector<int>& one, const std::vector<int>& other) {
    for (std::size_t k = 0; k < one.size(); ++k) {
      const std::size_t next = (k + 1) % one.size();
      if (one[k] != one[next]) face(one[k], one[next], other[next]);
      if (other[k] != other[next]) face(one[k], other[next], other[k]);
    }
  }
  std::string vertices_, faces_;
  int count_ = 0;
};

Model cup(double radius, double height, double wall) {
  return Model().lathe(
      {{0, 0}, {radius, 0}, {radius, height}, {radius - wall, height}, {radius - wall, wall}, {0, wall}});
}

/// Points on an arc in the xz plane.
std::vector<Vector3> arc(const Vector3& centre, double radius, double from, double to) {
  constexpr int kPoints = 14;
  std::vector<Vector3> points;
  for (int i = 0; i < kPoints; ++i) {
    const double angle = from + (to - from) * i / (kPoints - 1);
    points.push_back(centre + radius * Vector3(std::cos(angle), 0.0, std::sin(angle)));
  }
  return points;
}

std::vector<double> radii(std::size_t count, double radius) {
  return std::vector<double>(count, radius);
}

std::string mug_with_handle(double diameter, double height) {
  return cup(0.5 * diameter, height, 0.004)
      .rod(arc({0.5 * diameter - 0.001, 0, 0.5 * height}, 0.03, -1.25, 1.25), radii(14, 0.005))
      .obj();
}

/// Half a hollow ball.
std::string bowl(double radius, double wall) {
  std::vector<std::array<double, 2>> profile;
  for (const double r : {radius, radius - wall})
    for (int i = 0; i < 10; ++i) {
      const double angle = 0.5 * M_PI * (r == radius ? i : 9 - i) / 9;
      profile.push_back({angle == 0.0 ? 0.0 : r * std::sin(angle), -r * std::cos(angle)});
    }
  return Model().lathe(profile).obj();
}

std::string ring(double radius, double thickness) {
  std::vector<std::array<double, 2>> profile;
  for (int i = 0; i < 20; ++i)
    profile.push_back(
        {radius + 0.5 * thickness * std::cos(0.1 * M_PI * i), 0.5 * thickness * std::sin(0.1 * M_PI * i)});
  return Model().lathe(profile).obj();
}

std::string banana() {
  std::vector<double> thick = radii(14, 0.018);
  for (const std::size_t end : {0, 13}) thick[end] = 0.006;
  for (const std::size_t end : {1, 12}) thick[end] = 0.013;
  return Model().rod(arc(Vector3::Zero(), 0.09, 0.2, 2.4), thick).obj();
}

std::string hammer() {
  return Model()
      .rod({{0, 0, 0}, {0.15, 0, 0}, {0.28, 0, 0}}, {0.014, 0.012, 0.013})
      .rod({{0.27, 0, -0.06}, {0.2701, 0, 0.06}}, {0.016, 0.016})
      .obj();
}

std::string pan() {
  return cup(0.11, 0.05, 0.003)
      .rod({{0.108, 0, 0.04}, {0.15, 0, 0.045}, {0.29, 0, 0.055}}, radii(3, 0.011))
      .obj();
}

const char* const kMesh = R"(<mesh filename="object.obj"/>)";

std::string collision(const std::string& shape, const std::string& origin = "") {
  return "<collision>" + origin + "<geometry>" + shape + "</geometry></collision>";
}

Scene scene_of(const test::Folder& folder, const Object& object) {
  if (!object.obj.empty()) folder.write("object.obj", object.obj);
  const std::string mass = object.obj.empty() ? "<inertial><mass value=\"0.1\"/></inertial>" : "";
  return load_scene(folder.write("object.urdf",
                                 test::thing(mass + object.collisions,
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
  EXPECT_STREQ("grasp_object", motion.name.c_str());
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
    ::testing::Values(
        Object{"box", collision(R"(<box size="0.08 0.06 0.03"/>)")},
        Object{"turned_box", collision(R"(<box size="0.03 0.08 0.06"/>)"), "0.4 0.7 1.9"},
        Object{"can", collision(R"(<cylinder radius="0.033" length="0.1"/>)")},
        Object{"lying_can", collision(R"(<cylinder radius="0.025" length="0.1"/>)"), "1.5708 0 0.5"},
        Object{"ball", collision(R"(<sphere radius="0.033"/>)")}, Object{"mug", mug()},
        Object{"turned_mug", mug(), "0.4 0.7 1.9"},
        Object{"pen", collision(R"(<capsule radius="0.006" length="0.12"/>)"), "0 1.5708 0"},
        Object{"tile", collision(R"(<box size="0.09 0.09 0.012"/>)"), "0 0 0.3"},
        Object{"mug_with_handle", collision(kMesh), "0 0 0.5", mug_with_handle(0.08, 0.095)},
        Object{"hull_of_a_mug", collision(std::string(kMesh) + "<!-- hull -->"), "0 0 0",
               mug_with_handle(0.08, 0.095)},
        Object{"cup_wider_than_the_hand", collision(kMesh), "0 0 0", cup(0.048, 0.1, 0.003).obj()},
        Object{"bowl", collision(kMesh), "0 0 0", bowl(0.08, 0.003)},
        Object{"pan", collision(kMesh), "0 0 0", pan()},
        Object{"plate", collision(kMesh), "0 0 0",
               Model()
                   .lathe({{0, 0}, {0.07, 0}, {0.12, 0.018}, {0.12, 0.022}, {0.07, 0.004}, {0, 0.004}})
                   .obj()},
        Object{"bottle", collision(kMesh), "0 0 0",
               Model()
                   .lathe({{0, 0}, {0.035, 0}, {0.035, 0.14}, {0.014, 0.18}, {0.014, 0.22}, {0, 0.22}})
                   .obj()},
        Object{"hammer", collision(kMesh), "0 0 0", hammer()},
        Object{"banana", collision(kMesh), "0 0 0", banana()},
        Object{"ring", collision(kMesh), "0 0 0", ring(0.05, 0.024)}),
    [](const auto& object) { return std::string(object.param.name); });

TEST(GraspObjectOf, holds_the_object_of_an_operators_scene_behind_its_fixtures) {
  const Scene scene = load_scene("config/scenes/handrails.urdf", {});
  ASSERT_TRUE(scene.bodies.front().fixed);
  EXPECT_NO_THROW(grasp_object(scene));
}

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
