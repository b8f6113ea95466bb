#include <gtest/gtest.h>

#include <map>
#include <set>

#include "scene/scene_files.h"

namespace mrhi {
namespace {

Scene shipped(const std::string& name) {
  return load_scene("config/scenes/" + name + ".urdf", {});
}

int count_fixtures(const Scene& scene) {
  int count = 0;
  for (const Body& body : scene.bodies) count += body.fixed;
  return count;
}

Vector3 box_moments(double mass, const Vector3& size) {
  const Vector3 squares = size.cwiseAbs2();
  return mass / 12 * (Vector3::Constant(squares.sum()) - squares);
}
Vector3 ball_moments(double mass, double radius) {
  return Vector3::Constant(0.4 * mass * radius * radius);
}
Vector3 cylinder_moments(double mass, double radius, double length) {
  const double across = mass / 12 * (3 * radius * radius + length * length);
  return {across, across, 0.5 * mass * radius * radius};
}

/// The files hold 12 digits.
void expect_moments(const Body& body, const Vector3& moments) {
  const Matrix3 expected = moments.asDiagonal();
  EXPECT_LT((body.inertia - expected).norm(), 1e-10 * moments.norm()) << body.name;
  EXPECT_LT((body.inertia * body.inverse_inertia - Matrix3::Identity()).norm(), 1e-12) << body.name;
}

const Body& only_body(const Scene& scene, const char* name, double mass) {
  EXPECT_EQ(1u, scene.bodies.size());
  const Body& body = scene.bodies.at(0);
  EXPECT_EQ(name, body.name);
  EXPECT_FALSE(body.fixed);
  EXPECT_EQ(mass, body.mass);
  EXPECT_EQ(Vector3(0, 0, 0.22), body.start.position);
  EXPECT_EQ(Vector3::Zero(), scene.gravity);
  return body;
}

const Body& body_of(const Scene& scene, const char* name) {
  return scene.bodies.at(find_body(scene, name).value());
}

/// Half extents of a shape around its body's start, in world; the shipped bodies start along the axes.
struct Extent {
  std::string body;
  Vector3 min, max;
};

std::vector<Vector3> corners(const Shape& shape) {
  if (const auto* mesh = std::get_if<Mesh>(&shape)) return mesh->triangles->vertices;
  Vector3 half = Vector3::Zero();
  if (const auto* box = std::get_if<Box>(&shape)) half = box->half_extents;
  if (const auto* sphere = std::get_if<Sphere>(&shape)) half.setConstant(sphere->radius);
  if (const auto* c = std::get_if<Cylinder>(&shape)) half = Vector3(c->radius, c->radius, c->half_length);
  std::vector<Vector3> all;
  for (int i = 0; i < 8; ++i) {
    all.push_back(half.cwiseProduct(Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1)));
  }
  return all;
}

std::vector<Extent> extents(const Scene& scene) {
  std::vector<Extent> all;
  for (const Body& body : scene.bodies) {
    for (const PlacedShape& placed : body.shapes) {
      Extent extent{body.name, Vector3::Constant(1e9), Vector3::Constant(-1e9)};
      for (const Vector3& corner : corners(placed.shape)) {
        const Vector3 point = body.start * (placed.pose * corner);
        extent.min = extent.min.cwiseMin(point);
        extent.max = extent.max.cwiseMax(point);
      }
      all.push_back(extent);
    }
  }
  return all;
}

TEST(ShippedScenes, CubeIsThePapersCube) {
  const Scene scene = shipped("cube");
  const Body& cube = only_body(scene, "cube", 0.1);
  expect_moments(cube, box_moments(0.1, Vector3::Constant(0.05)));
  EXPECT_EQ(Vector3::Constant(0.025), std::get<Box>(cube.shapes.at(0).shape).half_extents);
  EXPECT_NEAR(0.025 * std::sqrt(3.0), cube.bounding_radius, 1e-15);
  EXPECT_FLOAT_EQ(0.902f, cube.visuals.at(0).rgba[0]);
}

TEST(ShippedScenes, FlatCuboidLiesLevel) {
  const Scene scene = shipped("flat_cuboid");
  expect_moments(only_body(scene, "flat_cuboid", 0.08), box_moments(0.08, {0.1, 0.07, 0.012}));
}

TEST(ShippedScenes, LongCuboidStandsUpright) {
  const Scene scene = shipped("long_cuboid");
  expect_moments(only_body(scene, "long_cuboid", 0.05), box_moments(0.05, {0.02, 0.02, 0.2}));
}

TEST(ShippedScenes, BallBounces) {
  const Scene scene = shipped("ball");
  const Body& ball = only_body(scene, "ball", 0.06);
  expect_moments(ball, ball_moments(0.06, 0.03));
  EXPECT_EQ(0.6, ball.material.restitution);
  EXPECT_EQ(Material().static_friction, ball.material.static_friction);
}

TEST(ShippedScenes, MixedHasFiveFreeConvexBodies) {
  const Scene scene = shipped("mixed");
  ASSERT_EQ(5u, scene.bodies.size());
  EXPECT_EQ(0, count_fixtures(scene));
  expect_moments(body_of(scene, "cube"), box_moments(0.1, Vector3::Constant(0.05)));
  expect_moments(body_of(scene, "ball"), ball_moments(0.06, 0.03));
  expect_moments(body_of(scene, "cylinder"), cylinder_moments(0.06, 0.018, 0.1));
  expect_moments(body_of(scene, "flat_cuboid"), box_moments(0.08, {0.1, 0.07, 0.012}));
  expect_moments(body_of(scene, "long_cuboid"), box_moments(0.05, {0.02, 0.02, 0.2}));
  EXPECT_EQ(Vector3(0.05, 0.06, 0.17), body_of(scene, "cube").start.position);
  EXPECT_EQ(0.5, body_of(scene, "flat_cuboid").material.dynamic_friction);
  for (const Body& body : scene.bodies) EXPECT_FALSE(std::holds_alternative<Mesh>(body.shapes.at(0).shape));
}

TEST(ShippedScenes, RackHasFixturesAndLooseItems) {
  const Scene scene = shipped("rack");
  ASSERT_EQ(8u, scene.bodies.size());
  EXPECT_EQ(4, count_fixtures(scene));
  EXPECT_EQ(3u, body_of(scene, "handrail").shapes.size());
  EXPECT_TRUE(body_of(scene, "left_wall").start.position.isApprox(Vector3(-0.205, 0.15, 0.245), 1e-15));
  EXPECT_EQ(0.7, body_of(scene, "handrail").material.dynamic_friction);
  EXPECT_EQ(Vector3(0.8, 0.8, 1.2), scene.bounds.max);
  expect_moments(body_of(scene, "canister"), cylinder_moments(0.12, 0.025, 0.09));
  expect_moments(body_of(scene, "pouch"), box_moments(0.15, {0.08, 0.06, 0.05}));
  expect_moments(body_of(scene, "ball"), ball_moments(0.03, 0.02));
}

/// Second moments of a solid of triangles about the origin, exact (signed tetrahedra to the origin).
Matrix3 second_moments(const TriangleMesh& mesh) {
  Matrix3 sum = Matrix3::Zero();
  for (const auto& t : mesh.triangles) {
    const Vector3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vector3 s = a + b + c;
    sum += a.dot(b.cross(c)) / 120 *
           (a * a.transpose() + b * b.transpose() + c * c.transpose() + s * s.transpose());
  }
  return sum;
}

// 1e-6: the STL holds floats, some 1e-8 of the length in each coordinate.
TEST(ShippedScenes, SpannerIsAClosedHomogeneousSolidAboutItsCentreOfMass) {
  const Scene scene = shipped("rack");
  const Body& spanner = body_of(scene, "spanner");
  const PlacedShape& placed = spanner.shapes.at(0);
  TriangleMesh mesh = *std::get<Mesh>(placed.shape).triangles;
  EXPECT_LT(mesh.triangles.size(), 200u);
  for (Vector3& vertex : mesh.vertices) vertex = placed.pose * vertex;
  ASSERT_GT(test::volume(mesh), 2e-5);

  Vector3 centre = Vector3::Zero();
  for (const auto& t : mesh.triangles) {
    const Vector3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    centre += a.dot(b.cross(c)) / 24 * (a + b + c) / test::volume(mesh);
  }
  EXPECT_LT(centre.norm(), 1e-8);
  const Matrix3 second = spanner.mass / test::volume(mesh) * second_moments(mesh);
  const Matrix3 expected = second.trace() * Matrix3::Identity() - second;
  EXPECT_LT((spanner.inertia - expected).norm(), 1e-6 * expected.norm());
  EXPECT_TRUE((spanner.start * spanner.link_in_body.position).isApprox(Vector3(-0.05, 0.07, 0.25), 1e-12));
}

TEST(ShippedScenes, NothingOverlapsAtTheStart) {
  for (const char* name : {"cube", "flat_cuboid", "long_cuboid", "ball", "mixed", "rack", "cube_on_table"}) {
    const std::vector<Extent> all = extents(shipped(name));
    for (const Extent& a : all) {
      for (const Extent& b : all) {
        if (a.body >= b.body) continue;
        const double gap = std::max((a.min - b.max).maxCoeff(), (b.min - a.max).maxCoeff());
        EXPECT_GE(gap, -1e-9) << name << ": " << a.body << " and " << b.body;
      }
    }
  }
}

TEST(ShippedScenes, FreeBodiesStartInReachOfTheHands) {
  const Vector3 min(-0.15, -0.1, 0.12), max(0.15, 0.15, 0.35);
  for (const char* name : {"cube", "flat_cuboid", "long_cuboid", "ball", "mixed", "rack", "cube_on_table"}) {
    for (const Body& body : shipped(name).bodies) {
      if (body.fixed) continue;
      EXPECT_TRUE((body.start.position.array() >= min.array()).all() &&
                  (body.start.position.array() <= max.array()).all())
          << name << ": " << body.name << " at " << body.start.position.transpose();
    }
  }
}

TEST(ShippedScenes, FreeBodiesOfOneSceneDifferInColour) {
  for (const char* name : {"mixed", "rack"}) {
    std::set<std::array<float, 4>> colours;
    int free_bodies = 0;
    for (const Body& body : shipped(name).bodies) {
      if (body.fixed) continue;
      ++free_bodies;
      colours.insert(body.visuals.at(0).rgba);
    }
    EXPECT_EQ(free_bodies, static_cast<int>(colours.size())) << name;
  }
}

TEST(ShippedScenes, AreFoundByNameAndListedWhenTheNameIsWrong) {
  EXPECT_EQ("config/scenes/cube.urdf", find_scene_file("cube", {"nowhere", "config/scenes"}));
  EXPECT_EQ("config/scenes/rack.urdf", find_scene_file("config/scenes/rack.urdf", {}));
  for (const char* wrong : {"cubes", "some/where.urdf", "cubes.urdf"}) {
    try {
      find_scene_file(wrong, {"config/scenes"});
      ADD_FAILURE() << wrong;
    } catch (const SceneError& error) {
      test::expect_words(error.what(),
                         {wrong,
                          "bag, ball, crate, cube, cube_on_table, docking, flat_cuboid, handrails, "
                          "hatch, long_cuboid, mixed, panel, rack, tongs"});
    }
  }
}

}  // namespace
}  // namespace mrhi
