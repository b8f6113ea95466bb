#include <gtest/gtest.h>

#include "placed_shapes.h"

namespace mrhi {
namespace {

constexpr double kRight = 1.5707963267948966;

const ManifoldPoint& point(const Manifold& manifold, int i) {
  return manifold.points[std::size_t(i)];
}

TEST(CylinderManifold, standing_touches_with_four_points_of_its_rim) {
  const Manifold m = on_plate(kCan, {{0.1, 0.2, 0.0298}, turn(0.7, Vector3::UnitZ())});
  ASSERT_EQ(m.count, 4);
  EXPECT_LT((m.normal - Vector3::UnitZ()).norm(), kRounding);
  Vector3 middle = Vector3::Zero();
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(point(m, i).depth, 0.0002, kRounding);
    EXPECT_NEAR((point(m, i).point - Vector3(0.1, 0.2, -0.0001)).norm(), 0.02, kRounding);
    middle += 0.25 * point(m, i).point;
  }
  EXPECT_LT((middle - Vector3(0.1, 0.2, -0.0001)).norm(), kRounding);
}

TEST(CylinderManifold, standing_still_its_points_do_not_wander) {
  Random random(2);
  const Pose rest{{0.1, 0.2, 0.0298}, turn(0.7, Vector3::UnitZ())};
  const Manifold first = on_plate(kCan, rest);
  for (int i = 0; i < 1000; ++i) {
    Pose moved = rest;
    moved.position += random.in_box(Vector3::Constant(1e-7));
    moved.orientation = turn(random.between(-2e-5, 2e-5), random.direction()) * moved.orientation;
    const Manifold now = on_plate(kCan, moved);
    ASSERT_EQ(now.count, 4);
    for (int k = 0; k < 4; ++k) {
      EXPECT_EQ(point(now, k).feature, point(first, k).feature);
      // 2e-5 rad leave the rim within 0.8 um of level: the points move with the cylinder, 36 mm from its
      // centre.
      EXPECT_LT((point(now, k).point - point(first, k).point).norm(), 2e-6);
    }
  }
}

TEST(CylinderManifold, tilted_touches_with_the_lowest_of_its_rim) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const double tilt = std::pow(10.0, random.between(-6, 0.1));
    const Vector3 about = turn(random.between(0, 6.283), Vector3::UnitZ()) * Vector3::UnitX();
    const Quaternion orientation = turn(tilt, about) * turn(random.between(0, 6.283), Vector3::UnitZ());
    const double lowest = 0.03 * std::cos(tilt) + 0.02 * std::sin(tilt);
    const Manifold m = on_plate(kCan, {{0, 0, lowest - 0.0001}, orientation});
    SCOPED_TRACE(tilt);
    ASSERT_GE(m.count, 1);
    EXPECT_LT((m.normal - Vector3::UnitZ()).norm(), kRounding);
    EXPECT_LE(deepest(m), 0.0001 + kRounding);
    // Up to 20 um out of level the rim's points follow the lowest only in part.
    EXPECT_GT(deepest(m), 0.0001 - (tilt * 0.04 < 20e-6 ? 3e-6 : 1e-11));
  }
}

TEST(CylinderManifold, lying_touches_with_both_ends_of_its_side) {
  const Quaternion along_x = turn(kRight, {0, 1, 0});
  for (const double roll : {0.0, 0.3, 2.0}) {
    const Manifold m = on_plate(kCan, {{0, 0, 0.0199}, turn(roll, {1, 0, 0}) * along_x});
    ASSERT_EQ(m.count, 2);
    EXPECT_LT((m.normal - Vector3::UnitZ()).norm(), kRounding);
    for (int i = 0; i < 2; ++i) {
      EXPECT_NEAR(point(m, i).depth, 0.0001, kRounding);
      EXPECT_NEAR(std::abs(point(m, i).point.x()), 0.03, kRounding);
      EXPECT_NEAR(point(m, i).point.y(), 0, kRounding);
      EXPECT_EQ(point(m, i).feature, i);
    }
  }
}

TEST(CylinderManifold, lying_over_the_border_touches_up_to_it) {
  const Manifold m = on_plate(kCan, {{0.49, 0, 0.0199}, turn(kRight, {0, 1, 0})});
  ASSERT_EQ(m.count, 2);
  EXPECT_NEAR(std::max(point(m, 0).point.x(), point(m, 1).point.x()), 0.5, kRounding);
  EXPECT_NEAR(std::min(point(m, 0).point.x(), point(m, 1).point.x()), 0.46, kRounding);
}

TEST(CylinderManifold, lying_on_the_border_itself_touches_along_it) {
  // Its axis 2 mm beyond the border of the plate and parallel to it: the edge is 2 mm beside the lowest line.
  const double height = std::sqrt(0.02 * 0.02 - 0.002 * 0.002);
  const Manifold m = on_plate(kCan, {{0.502, 0, height - 0.0001}, turn(kRight, {1, 0, 0})});
  ASSERT_EQ(m.count, 2);
  const double depth = 0.02 - std::hypot(0.002, height - 0.0001);
  for (int i = 0; i < 2; ++i) {
    EXPECT_NEAR(point(m, i).depth, depth, kRounding);
    EXPECT_NEAR(std::abs(point(m, i).point.y()), 0.03, kRounding);
  }
}

TEST(CylinderManifold, standing_over_the_border_touches_with_what_is_on_it) {
  const Manifold m = on_plate(kCan, at(0.505, 0, 0.0299));
  ASSERT_EQ(m.count, 4);
  double nearest = -1e300;
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(point(m, i).depth, 0.0001, kRounding);
    EXPECT_LE(point(m, i).point.x(), 0.5 + 0.0001);  // 0.5 % of the radius: rim points near the border count
    EXPECT_LE((point(m, i).point - Vector3(0.505, 0, -0.00005)).norm(), 0.02 + kRounding);
    nearest = std::max(nearest, point(m, i).point.x());
  }
  EXPECT_NEAR(nearest, 0.5, 0.0001);
}

TEST(CylinderManifold, stacked_and_side_by_side) {
  const Manifold stacked = body_manifold(kCan, at(0, 0, 0.0599), kCan, {}, 0.001);
  ASSERT_EQ(stacked.count, 4);
  EXPECT_LT((stacked.normal - Vector3::UnitZ()).norm(), kRounding);
  EXPECT_NEAR(deepest(stacked), 0.0001, kRounding);
  const Manifold beside = body_manifold(kCan, at(0.0399, 0, 0.01), kCan, {}, 0.001);
  ASSERT_EQ(beside.count, 2);
  EXPECT_NEAR(deepest(beside), 0.0001, kRounding);
  EXPECT_NEAR(std::min(point(beside, 0).point.z(), point(beside, 1).point.z()), -0.02, kRounding);
  EXPECT_NEAR(std::max(point(beside, 0).point.z(), point(beside, 1).point.z()), 0.03, kRounding);
  const Manifold crossed = body_manifold(kCan, {{0.0399, 0, 0}, turn(kRight, {1, 0, 0})}, kCan, {}, 0.001);
  ASSERT_EQ(crossed.count, 1);
  EXPECT_NEAR(crossed.points[0].depth, 0.0001, kRounding);
  EXPECT_LT((crossed.points[0].point - Vector3(0.01995, 0, 0)).norm(), 1e-9);
}

TEST(CylinderManifold, small_stands_on_large_with_its_whole_rim) {
  for (const Shape& below : {Shape(Cylinder{0.05, 0.01}), Shape(Box{{0.05, 0.05, 0.01}})}) {
    const Manifold m = body_manifold(kCan, at(0.01, 0.02, 0.0399), below, {}, 0.001);
    ASSERT_EQ(m.count, 4);
    const Manifold turned_over = body_manifold(below, at(0.01, 0.02, 0.0399), kCan, {}, 0.001);
    ASSERT_EQ(turned_over.count, 4);
    for (int i = 0; i < 4; ++i) {
      const Vector3 from_axis = point(m, i).point - Vector3(0.01, 0.02, 0.00995);
      EXPECT_NEAR(from_axis.norm(), 0.02, kRounding);
      EXPECT_NEAR((point(turned_over, i).point - Vector3(0, 0, 0.02995)).norm(), 0.02, kRounding);
    }
  }
}

}  // namespace
}  // namespace mrhi
