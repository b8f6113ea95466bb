#include <gtest/gtest.h>
#include <visualization_msgs/Marker.h>

#include <algorithm>

#include "ros/marker_layers.h"
#include "support/fixtures.h"
#include "tracking/adult_hand.h"

namespace mrhi {
namespace {

constexpr double kHalf = 0.025;  // of the cube [m]

/// A cube at a height over the origin, and its shadow.
struct Shaded {
  explicit Shaded(double height) : scene(testing::scene_of(testing::box_body({0.05, 0.05, 0.05}, 0.1))) {
    scene.bodies[0].start.position = Vector3(0.0, 0.0, height);
  }

  const visualization_msgs::MarkerArray& shadows(double ground) {
    SimulationState state;
    for (const Body& body : scene.bodies) state.bodies.push_back(start_state(body));
    array.markers.clear();
    MarkerLayer layer(array, std_msgs::Header(), "shadows", 0.0);
    ShadowMarkers(scene, ground).add(state, result, true, layer);
    return array;
  }

  double darkest(double ground) {
    double most = 0.0;
    for (const auto& marker : shadows(ground).markers)
      for (const auto& corner : marker.colors) most = std::max(most, static_cast<double>(corner.a));
    return most;
  }

  Scene scene;
  FrameResult result;
  visualization_msgs::MarkerArray array;
};

TEST(Shadows, lie_on_the_ground_under_the_thing) {
  Shaded cube(0.2);
  ASSERT_EQ(cube.shadows(0.1).markers.size(), 1u);
  const auto& marker = cube.array.markers[0];
  ASSERT_EQ(marker.points.size(), marker.colors.size());
  double widest = 0.0;
  for (std::size_t i = 0; i < marker.points.size(); ++i) {
    EXPECT_NEAR(marker.points[i].z, 0.1, 0.002);
    const double out = std::max(std::abs(marker.points[i].x), std::abs(marker.points[i].y));
    if (static_cast<double>(marker.colors[i].a) > 0.15) widest = std::max(widest, out);
  }
  EXPECT_NEAR(widest, kHalf, 0.008);  // a cell
}

TEST(Shadows, are_fainter_the_higher_a_thing_is_and_gone_where_it_is_far_or_below) {
  EXPECT_GT(Shaded(0.13).darkest(0.1), Shaded(0.3).darkest(0.1));
  EXPECT_EQ(Shaded(3.0).darkest(0.1), 0.0);
  EXPECT_EQ(Shaded(0.0).darkest(0.1), 0.0);
}

TEST(Shadows, hands_have_them_too) {
  Shaded cube(0.2);
  cube.result.rendered.push_back(
      {complete_hand(adult_hand(Side::right), Pose{{0.0, 0.0, 0.3}, Quaternion::Identity()}), {}});
  EXPECT_EQ(cube.shadows(0.1).markers.size(), 2u);
}

TEST(Shadows, fall_on_a_wide_level_fixture_under_all_that_is_free_else_on_the_grid) {
  Shaded cube(0.2);
  EXPECT_DOUBLE_EQ(ground_height(cube.scene), 0.1);
  Body table = testing::box_body({0.4, 0.4, 0.02}, 1.0);
  table.fixed = true;
  table.start.position.z() = 0.16;
  cube.scene.bodies.push_back(table);
  EXPECT_DOUBLE_EQ(ground_height(cube.scene), 0.17);
  cube.scene.bodies.back().start.position.z() = 0.5;
  EXPECT_DOUBLE_EQ(ground_height(cube.scene), 0.1);
  EXPECT_LT(ground_height(Shaded(0.0).scene), -kHalf);
}

}  // namespace
}  // namespace mrhi
