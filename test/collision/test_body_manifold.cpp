#include "collision/body_manifold.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "mesh_shapes.h"
#include "placed_shapes.h"

namespace mrhi {
namespace {

const Shape kCube = Box{{0.025, 0.025, 0.025}};

std::set<int> features(const Manifold& manifold) {
  std::set<int> names;
  for (int i = 0; i < manifold.count; ++i) names.insert(manifold.points[std::size_t(i)].feature);
  return names;
}

double distance_to(const Manifold& manifold, const Vector3& place) {
  double least = 1e300;
  for (int i = 0; i < manifold.count; ++i) {
    least = std::min(least, (manifold.points[std::size_t(i)].point - place).norm());
  }
  return least;
}

// Side by side and one above the other, flush: each direction alone has a face, both together only an edge.
TEST(BodyManifold, boxes_that_share_an_edge_alone_pass_each_other_and_one_that_stands_on_its_edge_touches) {
  constexpr double kBreadth = 1e-6;
  const auto touches = [&](const Pose& pose) {
    return body_manifold(kCube, pose, kCube, {}, 1e-5, kBreadth).count > 0;
  };
  EXPECT_TRUE(touches(at(0.05, 0, 0)));
  EXPECT_TRUE(touches(at(0, 0, 0.05)));
  EXPECT_FALSE(touches(at(0.05, 0, 0.05)));
  EXPECT_FALSE(touches(at(0.05 - 5e-7, 0, 0.05 - 5e-7)));
  EXPECT_FALSE(touches(at(0.05, 0.05, 0.05)));
  EXPECT_TRUE(touches(at(0.05 - 3e-6, 0, 0.05)));
  EXPECT_EQ(body_manifold(kCube, at(0.05, 0, 0.05), kCube, {}, 1e-5).count, 2);
  const Pose on_edge{{0, 0, 0.025 * std::sqrt(2.0)}, turn(M_PI / 4, Vector3::UnitX())};
  EXPECT_EQ(body_manifold(kCube, on_edge, plate(), plate_pose(), 1e-5, kBreadth).count, 2);
}

TEST(BodyManifold, spheres_touch_on_the_line_between_their_centres) {
  const Vector3 between(0.01, 0.02, 0.02);  // 30 mm long
  const Manifold m =
      body_manifold(Shape(Sphere{0.02}), {between, Quaternion::Identity()}, Shape(Sphere{0.015}), {}, 0);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.points[0].depth, 0.005, kRounding);
  EXPECT_LT((m.normal - between / 0.03).norm(), kRounding);
  EXPECT_LT((m.points[0].point - 0.0125 / 0.03 * between).norm(), kRounding);
}

TEST(BodyManifold, sphere_on_a_box_and_a_cylinder_is_exact) {
  const Pose turned{{0.3, -0.2, 0.1}, turn(1.1, {1, 2, 3})};
  const auto ball = [&](const Vector3& local) { return Pose{turned * local, Quaternion::Identity()}; };
  const Manifold face = body_manifold(Shape(Sphere{0.02}), ball({0.01, 0.005, 0.043}), kCube, turned, 0);
  ASSERT_EQ(face.count, 1);
  EXPECT_NEAR(face.points[0].depth, 0.002, kRounding);
  EXPECT_LT((face.normal - turned.orientation * Vector3::UnitZ()).norm(), kRounding);
  EXPECT_LT((face.points[0].point - turned * Vector3(0.01, 0.005, 0.024)).norm(), kRounding);
  const Manifold corner = body_manifold(Shape(Sphere{0.02}), ball({0.035, 0.035, 0.035}), kCube, turned, 0);
  ASSERT_EQ(corner.count, 1);
  EXPECT_NEAR(corner.points[0].depth, 0.02 - std::sqrt(3) * 0.01, kRounding);
  const Manifold rim = body_manifold(Shape(Sphere{0.02}), ball({0.026, 0.008, 0.04}), kCan, turned, 0.01);
  ASSERT_EQ(rim.count, 1);
  EXPECT_NEAR(rim.points[0].depth, 0.02 - std::hypot(std::hypot(0.026, 0.008) - 0.02, 0.01), kRounding);
  const Manifold other_way =
      body_manifold(kCan, turned, Shape(Sphere{0.02}), ball({0.026, 0.008, 0.04}), 0.01);
  EXPECT_LT((other_way.normal + rim.normal).norm(), kRounding);
}

TEST(BodyManifold, box_lies_on_its_four_corners) {
  const Manifold m = on_plate(kCube, {{0.1, 0.05, 0.0249}, turn(0.4, Vector3::UnitZ())});
  ASSERT_EQ(m.count, 4);
  EXPECT_LT((m.normal - Vector3::UnitZ()).norm(), kRounding);
  for (const double x : {-0.025, 0.025}) {
    for (const double y : {-0.025, 0.025}) {
      const Vector3 corner = Vector3(0.1, 0.05, 0) + turn(0.4, Vector3::UnitZ()) * Vector3(x, y, 0);
      EXPECT_LT(distance_to(m, corner - 0.00005 * Vector3::UnitZ()), kRounding);
    }
  }
  for (int i = 0; i < 4; ++i) EXPECT_NEAR(m.points[std::size_t(i)].depth, 0.0001, kRounding);
  EXPECT_EQ(features(m), (std::set<int>{0, 1, 2, 3}));  // its own corners below
}

/// Jitter of a solver and of slow creep must not rename what touches, or friction forgets.
void expect_steady_names(const Shape& a, const Pose& pose_a, const Shape& b, const Pose& pose_b, double slide,
                         double rock) {
  Random random(1);
  const Manifold first = body_manifold(a, pose_a, b, pose_b, 0.001);
  EXPECT_EQ(first.count, 4);
  for (int i = 0; i < 2000; ++i) {
    Pose moved = pose_a;
    moved.position += random.in_box({slide, slide, std::min(slide, 1e-5)});
    moved.orientation = turn(random.between(-rock, rock), random.direction()) * moved.orientation;
    const Manifold now = body_manifold(a, moved, b, pose_b, 0.001);
    ASSERT_EQ(features(now), features(first)) << i;
    for (int k = 0; k < 4; ++k) {
      const auto p = std::size_t(k);
      EXPECT_EQ(now.points[p].feature, first.points[p].feature);
      EXPECT_LT((now.points[p].point - first.points[p].point).norm(), 3 * slide + 0.1 * rock + 2e-5);
    }
  }
}

TEST(BodyManifold, box_that_slides_and_rocks_on_a_plate_keeps_its_names) {
  expect_steady_names(kCube, {{0.1, 0.05, 0.0249}, turn(0.4, Vector3::UnitZ())}, plate(), plate_pose(), 0.005,
                      0.005);
}

TEST(BodyManifold, stacked_boxes_keep_their_names) {
  const Pose above = at(0, 0, 0.0499);
  const Pose offset = at(0.01, 0.004, 0.0499);
  const Pose turned{{0, 0, 0.0499}, turn(0.785398163397448, Vector3::UnitZ())};
  const Pose askew{{0.003, 0.001, 0.0499}, turn(0.3, Vector3::UnitZ())};
  for (const Pose& pose : {above, offset, turned, askew}) {
    for (const double jitter : {0.0, 1e-12, 1e-9, 1e-7, 1e-6}) {
      SCOPED_TRACE(jitter);
      expect_steady_names(kCube, pose, kCube, {}, jitter, jitter);
    }
  }
  expect_steady_names(kCube, above, kCube, {}, 5e-5, 1e-4);
}

TEST(BodyManifold, stack_overhanging_touches_in_the_overlap) {
  const Manifold m = body_manifold(kCube, at(0.02, 0.01, 0.05), kCube, {}, 0.001);
  ASSERT_EQ(m.count, 4);
  for (const double x : {-0.005, 0.025}) {
    for (const double y : {-0.015, 0.025}) EXPECT_LT(distance_to(m, {x, y, 0.025}), kRounding);
  }
}

TEST(BodyManifold, many_corners_become_four_well_spread) {
  const Manifold m =
      body_manifold(kCube, {{0, 0, 0.0499}, turn(0.785398163397448, Vector3::UnitZ())}, kCube, {}, 0.001);
  ASSERT_EQ(m.count, 4);
  // A regular octagon about a circle of 25 mm: its corners are 27.06 mm out; four of them make a square.
  Vector3 middle = Vector3::Zero();
  for (int i = 0; i < 4; ++i) middle += 0.25 * m.points[std::size_t(i)].point;
  EXPECT_LT((middle - Vector3(0, 0, 0.02495)).norm(), 1e-9);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR((m.points[std::size_t(i)].point - middle).norm(), 0.025 / std::cos(0.392699), 1e-8);
  }
}

TEST(BodyManifold, box_on_its_edge_touches_with_the_edge) {
  const double half_diagonal = 0.025 * std::sqrt(2.0);
  const Manifold m = on_plate(kCube, {{0, 0, half_diagonal - 0.0002}, turn(0.785398163397448, {1, 0, 0})});
  ASSERT_EQ(m.count, 2);
  for (const double x : {-0.025, 0.025}) EXPECT_LT(distance_to(m, {x, 0, -0.0001}), 1e-9);
  for (int i = 0; i < 2; ++i) EXPECT_NEAR(m.points[std::size_t(i)].depth, 0.0002, kRounding);
}

TEST(BodyManifold, box_on_its_corner_touches_with_the_corner) {
  const Quaternion on_corner = Quaternion::FromTwoVectors(Vector3(-1, -1, -1), -Vector3::UnitZ());
  const Manifold m = on_plate(kCube, {{0.2, 0.1, 0.025 * std::sqrt(3.0) - 0.0003}, on_corner});
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.points[0].depth, 0.0003, kRounding);
  EXPECT_EQ(m.points[0].feature, 0);
  EXPECT_LT((m.points[0].point - Vector3(0.2, 0.1, -0.00015)).norm(), kRounding);
}

TEST(BodyManifold, edges_that_cross_touch_at_a_point) {
  const double half_diagonal = 0.025 * std::sqrt(2.0), z = 2 * half_diagonal - 0.0004;
  const Pose ridge_x{{0, 0, 0}, turn(0.785398163397448, {1, 0, 0})};
  const Pose ridge_y{{0.004, 0.003, z}, turn(0.785398163397448, {0, 1, 0})};
  const Manifold m = body_manifold(kCube, ridge_y, kCube, ridge_x, 0.001);
  ASSERT_EQ(m.count, 1);
  EXPECT_NEAR(m.points[0].depth, 0.0004, kRounding);
  EXPECT_LT((m.normal - Vector3::UnitZ()).norm(), kRounding);
  EXPECT_LT((m.points[0].point - Vector3(0.004, 0, half_diagonal - 0.0002)).norm(), kRounding);
}

TEST(BodyManifold, gaps_are_reported_up_to_the_margin) {
  EXPECT_EQ(on_plate(kCube, at(0, 0, 0.0259), 0.001).count, 4);
  EXPECT_NEAR(on_plate(kCube, at(0, 0, 0.0259), 0.001).points[0].depth, -0.0009, kRounding);
  EXPECT_EQ(on_plate(kCube, at(0, 0, 0.0261), 0.001).count, 0);
  EXPECT_EQ(on_plate(kCan, at(0, 0, 0.0309), 0.001).count, 4);
  EXPECT_EQ(on_plate(kCan, at(0, 0, 0.0311), 0.001).count, 0);
  // Corner beside corner: 0.3, 0.4 and 1.2 mm along the axes are 1.3 mm.
  const Manifold corners = body_manifold(kCube, at(0.0503, 0.0504, 0.0512), kCube, {}, 0.0014);
  ASSERT_EQ(corners.count, 1);
  EXPECT_NEAR(corners.points[0].depth, -0.0013, kRounding);
  EXPECT_EQ(body_manifold(kCube, at(0.0503, 0.0504, 0.0512), kCube, {}, 0.0012).count, 0);
}

/// Forms to come, that give no more than their farthest point: a can that does not say that it is a prism.
TEST(BodyManifold, any_convex_form_touches_with_the_place_that_faces_the_other) {
  Random random(4);
  ManifoldShape form(kCan);
  form.prism.reset();
  const Shape floor = plate();
  for (int i = 0; i < 200; ++i) {
    const double tilt = random.between(0.05, 1.5);
    const Quaternion orientation = turn(random.between(0, 6.283), Vector3::UnitZ()) * turn(tilt, {1, 0, 0});
    const double lowest = 0.03 * std::cos(tilt) + 0.02 * std::sin(tilt);
    const Manifold m =
        body_manifold(form, {{0.1, 0.2, lowest - 0.0001}, orientation}, floor, plate_pose(), 0.001);
    ASSERT_EQ(m.count, 1);
    EXPECT_LT((m.normal - Vector3::UnitZ()).norm(), kRounding);
    EXPECT_NEAR(m.points[0].depth, 0.0001, kRounding);
  }
}

TEST(BodyManifold, mesh_needs_its_collider) {
  const auto triangles = std::make_shared<TriangleMesh>(box_mesh({0.02, 0.03, 0.01}));
  const Shape shape = Mesh{triangles, "", Vector3::Ones()};
  EXPECT_THROW(ManifoldShape{shape}, std::invalid_argument);
}

TEST(BodyManifold, mesh_of_a_box_lies_on_its_four_corners_and_carries_a_box) {
  const auto triangles = std::make_shared<TriangleMesh>(box_mesh({0.04, 0.03, 0.01}));
  const Shape shape = Mesh{triangles, "", Vector3::Ones()};
  const MeshCollider collider(*triangles);
  const ManifoldShape mesh(shape, &collider);
  const Manifold below = body_manifold(mesh, at(0, 0, 0.0099), plate(), plate_pose(), 0.001);
  ASSERT_EQ(below.count, 4);
  EXPECT_LT((below.normal - Vector3::UnitZ()).norm(), kRounding);
  const Manifold above = body_manifold(kCube, at(0, 0, 0.0349), mesh, {}, 0.001);
  ASSERT_EQ(above.count, 4);
  EXPECT_LT((above.normal - Vector3::UnitZ()).norm(), kRounding);
  for (const double x : {-1.0, 1.0}) {
    for (const double y : {-1.0, 1.0}) {
      EXPECT_LT(distance_to(below, {0.04 * x, 0.03 * y, -0.00005}), kRounding);
      EXPECT_LT(distance_to(above, {0.025 * x, 0.025 * y, 0.00995}), kRounding);
    }
  }
  const Manifold lying =
      body_manifold(kCan, {{0, 0, 0.0299}, turn(1.5707963267948966, {0, 1, 0})}, mesh, {}, 0.001);
  const auto overlaps = [](const ManifoldPoint& p) { return p.depth > 0; };
  EXPECT_EQ(std::count_if(lying.points.begin(), lying.points.begin() + lying.count, overlaps), 2);
  EXPECT_NEAR(deepest(lying), 0.0001, 1e-9);
  const Manifold standing = body_manifold(kCan, at(0, 0, 0.0399), mesh, {}, 0.001);
  ASSERT_EQ(standing.count, 4);
  EXPECT_NEAR(deepest(standing), 0.0001, kRounding);
  const Manifold ball = body_manifold(Shape(Sphere{0.02}), at(0.01, 0, 0.029), mesh, {}, 0.001);
  ASSERT_EQ(ball.count, 1);
  EXPECT_NEAR(ball.points[0].depth, 0.001, kRounding);
  const Manifold on_mesh = body_manifold(mesh, {{0, 0, 0.0199}, turn(0.5, {0, 0, 1})}, mesh, {}, 0.001);
  EXPECT_EQ(on_mesh.count, 4);
  EXPECT_NEAR(deepest(on_mesh), 0.0001, kRounding);
}

}  // namespace
}  // namespace mrhi
