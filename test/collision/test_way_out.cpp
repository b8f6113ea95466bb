#include <gtest/gtest.h>

#include "collision/closest_features.h"

namespace mrhi {
namespace {

constexpr double kExact = 1e-12;

TEST(WayOut, is_the_distance_to_the_far_side_along_the_line) {
  const Shape box = Box{Vector3(0.1, 0.2, 0.3)};
  EXPECT_NEAR(way_out(box, Vector3(0.02, 0.1, 0), Vector3::UnitX()).value(), 0.08, kExact);
  EXPECT_NEAR(way_out(box, Vector3(-0.5, 0.1, 0), Vector3::UnitX()).value(), 0.6, kExact);
  const Vector3 diagonal = Vector3(1, 1, 0).normalized();
  EXPECT_NEAR(way_out(box, Vector3(0.05, 0, 0), diagonal).value(), 0.05 * std::sqrt(2.0), kExact);
  const Shape sphere = Sphere{0.05};
  EXPECT_NEAR(way_out(sphere, Vector3(0, 0.03, 0.01), Vector3::UnitZ()).value(), 0.03, kExact);
  const Shape cylinder = Cylinder{0.05, 0.1};
  EXPECT_NEAR(way_out(cylinder, Vector3(0, 0.03, 0.02), Vector3::UnitZ()).value(), 0.08, kExact);
  EXPECT_NEAR(way_out(cylinder, Vector3(0, 0.03, 0.02), Vector3::UnitX()).value(), 0.04, kExact);
}

TEST(WayOut, is_negative_where_the_shape_lies_behind) {
  EXPECT_NEAR(way_out(Box{Vector3(0.1, 0.1, 0.1)}, Vector3(0, 0, 0.12), Vector3::UnitZ()).value(), -0.02,
              kExact);
  EXPECT_NEAR(way_out(Sphere{0.05}, Vector3(0, 0, 0.06), Vector3::UnitZ()).value(), -0.01, kExact);
}

TEST(WayOut, is_nothing_where_the_line_misses) {
  EXPECT_FALSE(way_out(Box{Vector3(0.1, 0.1, 0.1)}, Vector3(0.11, 0, 0), Vector3::UnitZ()));
  EXPECT_FALSE(way_out(Box{Vector3(0.1, 0.1, 0.1)}, Vector3(0.3, 0, 0), Vector3(1, 1, 0).normalized()));
  EXPECT_FALSE(way_out(Sphere{0.05}, Vector3(0, 0.051, 0), Vector3::UnitZ()));
  EXPECT_FALSE(way_out(Cylinder{0.05, 0.1}, Vector3(0.06, 0, 0), Vector3::UnitZ()));
  EXPECT_FALSE(way_out(Cylinder{0.05, 0.1}, Vector3(0, 0, 0.11), Vector3::UnitX()));
  EXPECT_FALSE(way_out(Mesh{}, Vector3::Zero(), Vector3::UnitX()));
}

TEST(WayOut, a_line_along_a_side_still_meets_the_shape) {
  EXPECT_TRUE(way_out(Box{Vector3(0.1, 0.1, 0.1)}, Vector3(0.1 + 1e-15, 0, 0), Vector3(1e-17, 0, 1)));
  EXPECT_TRUE(way_out(Cylinder{0.05, 0.1}, Vector3(0.05 + 1e-15, 0, 0), Vector3(0, 1e-17, 1)));
}

}  // namespace
}  // namespace mrhi
