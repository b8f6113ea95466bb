#include "mr_hand_interaction/scene/save_scene.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "mr_hand_interaction/scene/object_request.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/simulation.h"
#include "support/fixtures.h"
#include "support/joints.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

class SavedScene : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  static SceneOptions options() {
    SceneOptions options;
    options.resolve_package_uri = [](const std::string& uri) {
      return uri.substr(std::string("package://mr_hand_interaction/").size());
    };
    return options;
  }
  /// Saved as it is after so long without hands, and loaded again.
  static Scene now(const Simulation& simulation) {
    return scene_as_it_is(simulation.scene(), simulation.state().bodies, simulation.state().joints);
  }

  const fs::path folder_ = fs::temp_directory_path() / ("saved_scene_" + std::to_string(::getpid()));
};

/// To rounding; what hangs on a joint that is pressed on its limit, by what the limit gives.
void expect_same(const Simulation& a, const Simulation& b) {
  constexpr double kRounding = 1e-12, kLimit = 1e-7;
  ASSERT_EQ(a.scene().bodies.size(), b.scene().bodies.size());
  ASSERT_EQ(a.scene().joints.size(), b.scene().joints.size());
  EXPECT_EQ(a.scene().gravity, b.scene().gravity);
  EXPECT_EQ(a.scene().bounds.min, b.scene().bounds.min);
  for (std::size_t i = 0; i < a.scene().bodies.size(); ++i) {
    const Body& one = a.scene().bodies[i];
    const auto found = find_body(b.scene(), one.name);
    ASSERT_TRUE(found) << one.name;
    const Body& other = b.scene().bodies[static_cast<std::size_t>(*found)];
    const BodyState &x = a.state().bodies[i], &y = b.state().bodies[static_cast<std::size_t>(*found)];
    EXPECT_EQ(one.fixed, other.fixed) << one.name;
    EXPECT_EQ(one.shapes.size(), other.shapes.size()) << one.name;
    // What has none is shown by what collides.
    EXPECT_EQ(one.visuals.empty() ? one.shapes.size() : one.visuals.size(), other.visuals.size()) << one.name;
    EXPECT_NEAR(one.bounding_radius, other.bounding_radius, kRounding) << one.name;
    EXPECT_LT((x.pose.position - y.pose.position).norm(), one.fixed || one.flies ? kRounding : kLimit)
        << one.name;
    EXPECT_LT(x.pose.orientation.angularDistance(y.pose.orientation), kLimit) << one.name;
    if (one.fixed) continue;
    EXPECT_EQ(one.mass, other.mass);
    EXPECT_LT((one.inertia - other.inertia).norm(), kRounding * one.inertia.norm()) << one.name;
    EXPECT_LT((x.linear_momentum - y.linear_momentum).norm(), 1e-10) << one.name;
    EXPECT_LT((x.angular_momentum - y.angular_momentum).norm(), 1e-10) << one.name;
    EXPECT_EQ(one.material.restitution, other.material.restitution) << one.name;
    EXPECT_EQ(one.grasp, other.grasp) << one.name;
  }
  for (std::size_t j = 0; j < a.scene().joints.size(); ++j) {
    const Joint& one = a.scene().joints[j];
    const auto found = find_joint(b.scene(), one.name);
    ASSERT_TRUE(found) << one.name;
    const Joint& other = b.scene().joints[static_cast<std::size_t>(*found)];
    EXPECT_NEAR(a.state().joints[j].position, b.state().joints[static_cast<std::size_t>(*found)].position,
                kLimit);
    EXPECT_EQ(one.upper, other.upper);
    EXPECT_EQ(one.damping, other.damping);
    EXPECT_EQ(one.friction, other.friction);
    EXPECT_EQ(one.spring.has_value(), other.spring.has_value());
    EXPECT_EQ(one.detents.has_value(), other.detents.has_value());
    EXPECT_EQ(one.latch.has_value(), other.latch.has_value());
  }
}

TEST_F(SavedScene, of_every_shipped_scene_is_the_same_when_it_is_loaded) {
  for (const char* name : {"cube", "flat_cuboid", "long_cuboid", "ball", "mixed", "rack", "cube_on_table",
                           "panel", "hatch", "tongs"}) {
    Simulation before(load_scene(std::string("config/scenes/") + name + ".urdf", options()), {});
    testing::let_go_on(before, 0.0, 0.5, 100.0);
    save_scene(now(before), file(std::string(name) + ".urdf"));
    const Simulation after(load_scene(file(std::string(name) + ".urdf"), options()), {});
    SCOPED_TRACE(name);
    expect_same(before, after);
  }
}

/// A double pendulum that swings, and a free body that flies and turns.
TEST_F(SavedScene, goes_on_as_it_was_going) {
  Scene scene = testing::pendulum(2, 0.7, 9.81);
  for (Body& body : scene.bodies) body.link_in_body = {};
  Body free = testing::box_body({0.04, 0.05, 0.06}, 0.1);
  free.name = "free";
  free.grasp = GraspMode::never;
  free.start = {{0.4, 0.1, 0.6}, Quaternion(Eigen::AngleAxisd(1.0, Vector3(1, 2, 3).normalized()))};
  free.start_twist = {{0.1, 0.2, 0.3}, {1.0, -2.0, 0.5}};
  scene.bodies.push_back(free);
  for (Joint& joint : scene.joints) {
    joint.in_child = {};
    joint.in_child.position.z() = 0.15;
    scene.bodies[static_cast<std::size_t>(joint.child)].link_in_body = joint.in_child;
  }
  Simulation before(scene, {});
  testing::let_go_on(before, 0.0, 0.3, 100.0);
  save_scene(now(before), file("swing.urdf"));
  Simulation after(load_scene(file("swing.urdf"), options()), {});
  expect_same(before, after);
  testing::let_go_on(before, 0.31, 0.8, 100.0);
  testing::let_go_on(after, 0.0, 0.5, 100.0);
  EXPECT_NEAR(before.state().joints[1].position, after.state().joints[1].position, 0.05);
}

TEST_F(SavedScene, is_written_nowhere_but_where_nothing_is) {
  const Scene scene = load_scene("config/scenes/cube.urdf", {});
  save_scene(scene, file("once.urdf"));
  EXPECT_THROW(save_scene(scene, file("once.urdf")), std::invalid_argument);
  EXPECT_THROW(save_scene(scene, file("once.txt")), std::invalid_argument);
  EXPECT_THROW(save_scene(scene, file("no/such/folder.urdf")), std::runtime_error);
}

std::string text_of(const std::string& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

TEST(SpawnedUrdf, brings_all_its_links_and_joints_to_where_it_is_wanted) {
  ObjectRequest request;
  request.whole = true;
  request.name = "second";
  request.urdf = text_of("config/scenes/hatch.urdf");
  request.joints = "hatch_hinge: {friction: 0.7}";
  request.pose = {{0.0, 0.5, 0.1}, Quaternion(Eigen::AngleAxisd(M_PI / 2.0, Vector3::UnitZ()))};
  const Scene part = requested_scene(request, {});
  const Scene as_file = load_scene("config/scenes/hatch.urdf", {});
  ASSERT_EQ(part.bodies.size(), as_file.bodies.size());
  for (const Body& body : as_file.bodies) {
    const auto found = find_body(part, "second_" + body.name);
    ASSERT_TRUE(found) << body.name;
    const Vector3 wanted = request.pose * body.start.position;
    EXPECT_LT((part.bodies[static_cast<std::size_t>(*found)].start.position - wanted).norm(), 1e-12);
  }
  EXPECT_EQ(part.joints[static_cast<std::size_t>(*find_joint(part, "second_hatch_hinge"))].friction, 0.7);
}

TEST(SpawnedUrdf, is_refused_where_its_names_are_taken_or_no_names) {
  ObjectRequest request;
  request.whole = true;
  request.urdf = text_of("config/scenes/hatch.urdf");
  Scene scene = load_scene("config/scenes/hatch.urdf", {});
  const std::size_t before = scene.bodies.size();
  EXPECT_THROW(append(requested_scene(request, {}), scene), std::invalid_argument);
  EXPECT_EQ(scene.bodies.size(), before);
  request.name = "a/b";
  EXPECT_THROW(requested_scene(request, {}), SceneError);
  request.name = "a";
  request.joints = "no_such_joint: {friction: 1}";
  EXPECT_THROW(requested_scene(request, {}), SceneError);
  request.joints.clear();
  request.urdf = "<robot";
  EXPECT_THROW(requested_scene(request, {}), SceneError);
}

std::string refusal(const Scene& scene, const std::string& file) {
  try {
    save_scene(scene, file);
  } catch (const std::exception& error) {
    EXPECT_EQ(std::string(error.what()).find_first_of("\n\x1b"), std::string::npos) << error.what();
    return error.what();
  }
  return "";
}

TEST_F(SavedScene, has_a_path_that_file_systems_and_terminals_take) {
  const Scene scene = load_scene("config/scenes/cube.urdf", {});
  for (const std::string& name :
       {std::string("a\nb.urdf"), std::string("a\x1b[31m.urdf"), std::string("a\0b.urdf", 8),
        std::string(300, 'x') + ".urdf", std::string("a\x7f.urdf"), std::string("a.yaml")}) {
    const std::string said = refusal(scene, file(name));
    EXPECT_NE(said.find("allowed: one that ends in .urdf, each name in it at most 255 bytes"),
              std::string::npos)
        << said;
  }
  EXPECT_EQ(refusal(scene, "/nope/x.urdf"),
            "cannot write '/nope/x.urdf': its folder is not there; allowed: one that is");
  EXPECT_TRUE(fs::is_empty(folder_));
  EXPECT_EQ(refusal(scene, file(std::string(250, 'x') + ".urdf")), "");
}

TEST_F(SavedScene, leaves_every_file_alone_that_is_there) {
  Scene scene = load_scene("config/scenes/cube.urdf", {});
  auto wedge = std::make_shared<TriangleMesh>();
  wedge->vertices = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}, {0, 0, 0.1}};
  wedge->triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  scene.bodies[0].shapes = {{Mesh{wedge, "file:///wedge.obj", Vector3::Ones()}, {}}};
  std::ofstream(file("wedge_1.obj")) << "mine";
  EXPECT_EQ(refusal(scene, file("wedge.urdf")),
            "'" + file("wedge_1.obj") + "' is there already; allowed: a file that is not");
  fs::create_symlink("/nowhere/at/all", file("gone.yaml"));
  EXPECT_NE(refusal(scene, file("gone.urdf")).find("gone.yaml' is there already"), std::string::npos);
  std::string mine;
  std::ifstream(file("wedge_1.obj")) >> mine;
  EXPECT_EQ(mine, "mine");
  EXPECT_FALSE(fs::exists(file("wedge.urdf")) || fs::exists(file("wedge.yaml")));
}

/// No file may grow beyond so many bytes, as on a disk that is full.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) {
    signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit full{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &full);
  }
  ~FullDisk() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

TEST_F(SavedScene, that_does_not_fit_on_the_disk_is_told_and_nothing_of_it_is_left) {
  const Scene scene = load_scene(find_scene_file("mixed", {"config/scenes"}), options());
  std::string told;
  {
    const FullDisk full(64);
    try {
      save_scene(scene, file("whole.urdf"));
    } catch (const std::runtime_error& error) {
      told = error.what();
    }
  }
  EXPECT_EQ(told.rfind("cannot write '" + file("whole.urdf") + "': ", 0), 0u) << told;
  EXPECT_TRUE(fs::is_empty(folder_));
  save_scene(scene, file("whole.urdf"));
  EXPECT_EQ(load_scene(file("whole.urdf"), options()).bodies.size(), scene.bodies.size());
}

}  // namespace
}  // namespace mrhi
