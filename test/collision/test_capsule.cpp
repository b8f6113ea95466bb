#include <gtest/gtest.h>

#include "collision/closest_features.h"
#include "mesh_shapes.h"
#include "placed_shapes.h"

namespace mrhi {
namespace {

const Pill kPill{0.02, 0.03};

Quaternion lying() {
  return turn(0.5 * 3.141592653589793, Vector3::UnitY());  // along x
}

/// Of two segments' places, the least of many.
double brute_distance(const Capsule& a, const Capsule& b) {
  double least = 1e300;
  for (int i = 0; i <= 400; ++i) {
    const Vector3 place = a.axis_point(i / 400.0), along = b.end - b.start;
    const double t = std::max(0.0, std::min(along.dot(place - b.start) / along.squaredNorm(), 1.0));
    least = std::min(least, (place - b.axis_point(t)).norm());
  }
  return least;
}

TEST(Capsule, finger_beside_it_is_as_far_as_their_axes_are) {
  Random random(21);
  for (int i = 0; i < 2000; ++i) {
    const Capsule finger = capsule_about(random.in_box(Vector3::Constant(0.06)),
                                         random.between(0.01, 0.05) * random.direction(), 0.008);
    const ClosestFeatures features = kPill.closest(finger, 1.0);
    const double brute = brute_distance(finger, *kPill.core());
    EXPECT_LE(features.distance + 0.028, brute + kRounding);
    EXPECT_NEAR(features.distance + 0.028, brute, 2e-6 + 1e-7 / std::max(brute, 1e-3));
    EXPECT_NEAR(features.normal.norm(), 1.0, kRounding);
    const Vector3 facing = finger.axis_point(features.axis_parameter);
    EXPECT_LT((features.point + (features.distance + 0.008) * features.normal - facing).norm(), kRounding);
  }
}

TEST(Capsule, axes_that_cross_part_across_both) {
  const ClosestFeatures features = kPill.closest({{-0.05, 0, 0.01}, {0.05, 0, 0.01}, 0.008}, 1.0);
  EXPECT_NEAR(features.distance, -0.028, kRounding);
  EXPECT_NEAR(std::abs(features.normal.y()), 1.0, kRounding);
  const ClosestFeatures along = kPill.closest({{0, 0, -0.05}, {0, 0, 0.05}, 0.008}, 1.0);
  EXPECT_NEAR(along.distance, -0.028, kRounding);
  EXPECT_NEAR(along.normal.z(), 0.0, kRounding);
}

TEST(Capsule, finger_along_its_side_touches_at_two_points_and_across_it_at_one) {
  const Capsule beside{{0.03, 0, 0.01}, {0.03, 0, 0.09}, 0.008};
  const AxisSpan span = contact_span(beside, kPill, kPill.closest(beside, 1.0));
  EXPECT_NEAR(span.s0, 0.0, kRounding);
  EXPECT_NEAR(span.s1, 0.25, kRounding);
  const Capsule across{{0.03, -0.02, 0.01}, {0.03, 0.02, 0.01}, 0.008};
  const AxisSpan point = contact_span(across, kPill, kPill.closest(across, 1.0));
  EXPECT_EQ(point.s0, point.s1);
}

TEST(Capsule, the_way_out_ends_where_its_last_part_ends) {
  EXPECT_NEAR(exit_distance(kPill, Vector3::Zero(), Vector3::UnitZ()).value(), 0.05, kRounding);
  EXPECT_NEAR(exit_distance(kPill, Vector3::Zero(), Vector3::UnitX()).value(), 0.02, kRounding);
  EXPECT_NEAR(exit_distance(kPill, Vector3(0.012, 0, 0), Vector3::UnitZ()).value(), 0.046, kRounding);
  EXPECT_FALSE(exit_distance(kPill, Vector3(0.021, 0, 0), Vector3::UnitZ()));
}

TEST(Capsule, lies_on_a_plate_with_two_points_and_stands_on_one) {
  const Manifold lies = on_plate(Shape(kPill), {{0.1, 0, 0.0195}, lying()});
  ASSERT_EQ(lies.count, 2);
  EXPECT_EQ(lies.normal, Vector3::UnitZ());
  for (const ManifoldPoint& p : {lies.points[0], lies.points[1]}) {
    EXPECT_NEAR(p.depth, 0.0005, kRounding);
    EXPECT_NEAR(std::abs(p.point.x() - 0.1), 0.03, kRounding);
    EXPECT_NEAR(p.point.z(), -0.00025, kRounding);
  }
  const Manifold stands = on_plate(Shape(kPill), at(0, 0, 0.0495));
  ASSERT_EQ(stands.count, 1);
  EXPECT_NEAR(deepest(stands), 0.0005, kRounding);
}

// 40 mm of its 60 are on the plate. Tilted over the edge by less than a degree it is nearest there, but lies
// on the plate all the same.
TEST(Capsule, that_hangs_over_an_edge_keeps_the_face) {
  const auto triangles = std::make_shared<const TriangleMesh>(box_mesh({0.5, 0.5, 0.01}));
  const Shape mesh = Mesh{triangles, "", Vector3::Ones()};
  const MeshCollider collider(*triangles);
  for (const double tilt : {0.0, 1e-9, 1e-5, 1e-3}) {
    SCOPED_TRACE(tilt);
    const Pose pose{{0.49, 0, 0.02}, turn(tilt, Vector3::UnitY()) * lying()};
    for (const Manifold& m : {on_plate(Shape(kPill), pose),
                              body_manifold({mesh, &collider}, plate_pose(), Shape(kPill), pose, 0.001)}) {
      ASSERT_EQ(m.count, 2);
      EXPECT_NEAR(std::abs(m.normal.z()), 1.0, 1e-9);
      EXPECT_NEAR(std::abs(m.points[0].point.x() - m.points[1].point.x()), 0.04, 1e-4);
    }
  }
}

TEST(Capsule, lies_along_a_cylinder_and_another_capsule_with_two_points) {
  const Cylinder cylinder{0.03, 0.02};
  const Manifold on_cylinder =
      body_manifold(Shape(kPill), {{0, 0, 0.0499}, lying()}, Shape(cylinder), {{0, 0, 0}, lying()}, 0.001);
  ASSERT_EQ(on_cylinder.count, 2);
  EXPECT_NEAR(deepest(on_cylinder), 0.0001, 1e-9);
  const Manifold on_pill =
      body_manifold(Shape(kPill), {{0.02, 0, 0.0399}, lying()}, Shape(kPill), {{0, 0, 0}, lying()}, 0.001);
  ASSERT_EQ(on_pill.count, 2);
  EXPECT_NEAR(std::abs(on_pill.points[0].point.x() - on_pill.points[1].point.x()), 0.04, 1e-9);
  const Manifold crossed = body_manifold(Shape(kPill), {{0, 0, 0.0399}, lying()}, Shape(kPill),
                                         {{0, 0, 0}, turn(1.5, Vector3::UnitZ()) * lying()}, 0.001);
  EXPECT_EQ(crossed.count, 1);
}

}  // namespace
}  // namespace mrhi
