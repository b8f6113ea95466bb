#include <gtest/gtest.h>

#include <visualization_msgs/Marker.h>
#include <algorithm>
#include <map>

#include "mr_hand_interaction/synthetic/random.h"
#include "ros/marker_layers.h"
#include "support/fixtures.h"
#include "tracking/adult_hand.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

Vector3 place(const geometry_msgs::Point& point) {
  return {point.x, point.y, point.z};
}

/// Six volumes of what a list of triangles encloses, and whether each edge is passed once in either
/// direction.
struct Solid {
  explicit Solid(const std::vector<geometry_msgs::Point>& points) {
    std::map<std::array<long, 6>, int> edges;
    for (std::size_t i = 0; i + 2 < points.size(); i += 3) {
      const Vector3 a = place(points[i]), b = place(points[i + 1]), c = place(points[i + 2]);
      volume += a.cross(b).dot(c) / 6.0;
      area += (b - a).cross(c - a).norm() / 2.0;
      for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
        ++edges[key(p, q)];
        --edges[key(q, p)];
      }
    }
    closed = std::all_of(edges.begin(), edges.end(), [](const auto& edge) { return edge.second == 0; });
  }
  static std::array<long, 6> key(const Vector3& p, const Vector3& q) {
    std::array<long, 6> rounded{};
    for (int i = 0; i < 3; ++i) {
      rounded[std::size_t(i)] = std::lround(1e8 * p[i]);
      rounded[std::size_t(i + 3)] = std::lround(1e8 * q[i]);
    }
    return rounded;
  }
  double volume = 0.0, area = 0.0;
  bool closed = false;
};

class MarkerShapes : public ::testing::Test {
 protected:
  MarkerArray array_;
  MarkerLayer layer_{array_, std_msgs::Header(), "layer", 0.0};
};

TEST_F(MarkerShapes, an_arrow_goes_from_its_beginning_to_its_tip_and_is_closed) {
  Random random(1);
  for (int i = 0; i < 30; ++i) {
    const Vector3 begin = random.gaussian_vector(0.3), along = random.gaussian_vector(1.0).normalized();
    const Arrow arrow{begin, begin + 0.08 * along, 0.003, 0.006, 0.02};
    const Marker marker = add_arrow(arrow, color(1, 0, 0), i, layer_);
    EXPECT_EQ(marker.type, Marker::TRIANGLE_LIST);
    EXPECT_EQ(marker.points.size(), marker.colors.size());
    double lowest = 1.0, highest = -1.0;
    for (const auto& point : marker.points) {
      const Vector3 offset = place(point) - begin;
      const double height = offset.dot(along), off = (offset - height * along).norm();
      lowest = std::min(lowest, height), highest = std::max(highest, height);
      EXPECT_LE(off, (height > 0.0599 ? 0.006 : 0.003) + 1e-9);
    }
    EXPECT_NEAR(lowest, 0.0, 1e-9);
    EXPECT_NEAR(highest, 0.08, 1e-9);
    const Solid solid(marker.points);
    EXPECT_TRUE(solid.closed);
    // A prism and a pyramid on a regular dodecagon, whose area is 3 r^2; outward, so positive.
    EXPECT_NEAR(solid.volume, 3.0 * (9e-6 * 0.06 + 36e-6 * 0.02 / 3.0), 1e-12);
  }
}

TEST_F(MarkerShapes, an_arrow_may_be_all_head) {
  const Marker marker = add_arrow({{0, 0, 0}, {0, 0, 0.01}, 0.003, 0.006, 0.01}, color(1, 0, 0), 0, layer_);
  EXPECT_NEAR(Solid(marker.points).volume, 3.0 * 36e-6 * 0.01 / 3.0, 1e-12);
}

TEST_F(MarkerShapes, a_ring_is_as_much_of_a_full_turn_as_it_is_to_be) {
  const Pose pose{{0.1, 0.2, 0.3}, Quaternion(Eigen::AngleAxisd(0.8, Vector3(1, 2, 3).normalized()))};
  for (const double end : {0.25, 0.5, 0.999, 1.0}) {
    Marker marker;
    add_ring({0.02, 0.03, 0.0, end, 360.0}, pose, marker);
    // Polygons of 360 corners have 0.999949 of their circles' area.
    EXPECT_NEAR(Solid(marker.points).area, end * M_PI * (9e-4 - 4e-4), 1e-7);
    for (const auto& point : marker.points) {
      const Vector3 local = pose.to_local(place(point));
      EXPECT_NEAR(local.z(), 0.0, 1e-12);
      EXPECT_GT(local.norm(), 0.02 - 1e-9);
      EXPECT_LT(local.norm(), 0.03 + 1e-9);
      // Clockwise seen from z, from x on: the angle goes down from 0 to -end turns.
      double angle = std::atan2(-local.y(), local.x());
      if (angle < -1e-9) angle += 2.0 * M_PI;
      if (end < 0.9) {
        EXPECT_LE(angle, 2.0 * M_PI * end + 1e-9);
      }
    }
  }
  Marker nothing;
  add_ring({0.02, 0.03, 0.5, 0.5}, pose, nothing);
  EXPECT_TRUE(nothing.points.empty());
}

TEST_F(MarkerShapes, two_parts_of_a_ring_are_the_whole) {
  Marker parts, whole;
  add_ring({0.02, 0.03, 0.0, 0.5}, {}, parts);
  add_ring({0.02, 0.03, 0.5, 1.0}, {}, parts);
  add_ring({0.02, 0.03}, {}, whole);
  EXPECT_NEAR(Solid(parts.points).area, Solid(whole.points).area, 1e-12);
  EXPECT_EQ(parts.points.size(), whole.points.size());
}

struct DrawnHand {
  explicit DrawnHand(const Hand& hand, const Touching& touching = {}) {
    MarkerLayer layer{array, std_msgs::Header(), "hand", 0.0};
    add_capsules(hand, touching, {color(0.5, 0.5, 0.5), color(1, 0, 0), 1.0}, 200, layer);
  }
  int count(int type) const {
    return int(std::count_if(array.markers.begin(), array.markers.end(),
                             [type](const Marker& marker) { return marker.type == type; }));
  }
  MarkerArray array;
};

TEST_F(MarkerShapes, a_hand_of_capsules_has_a_ball_at_each_joint_and_a_cylinder_along_each_bone) {
  const Hand hand = complete_hand(adult_hand(Side::right), Pose{});
  const DrawnHand drawn(hand);
  std::map<int, int> ids;
  for (const Marker& marker : drawn.array.markers) {
    EXPECT_EQ(++ids[marker.id], 1);
    EXPECT_GE(marker.id, 200);
    EXPECT_LT(marker.id, 200 + kIdsPerHand);
    if (marker.type != Marker::CYLINDER) continue;
    const auto bone = std::find_if(hand.capsules.begin(), hand.capsules.end(), [&](const Capsule& capsule) {
      return capsule.radius > 0.0 && (capsule.centre() - place(marker.pose.position)).norm() < 1e-12;
    });
    ASSERT_NE(bone, hand.capsules.end());
    EXPECT_NEAR(marker.scale.z, (bone->end - bone->start).norm(), 1e-12);
    EXPECT_NEAR(marker.scale.x, 2.0 * bone->radius, 1e-12);
    EXPECT_EQ(marker.scale.x, marker.scale.y);
    const auto& q = marker.pose.orientation;
    const Vector3 z = Quaternion(q.w, q.x, q.y, q.z) * Vector3::UnitZ();
    EXPECT_LT(z.cross(bone->end - bone->start).norm(), 1e-9);
  }
  int bones = 0;
  for (int i = 0; i < kCapsules; ++i) {
    const Capsule& capsule = hand.capsules[std::size_t(i)];
    bones += hand.has(i) && (capsule.end - capsule.start).norm() > 1e-6;
  }
  EXPECT_EQ(drawn.count(Marker::CYLINDER), bones);
}

TEST_F(MarkerShapes, what_is_not_tracked_is_not_drawn_and_what_follows_begins_with_a_ball) {
  Hand hand = complete_hand(adult_hand(Side::right), Pose{});
  const DrawnHand whole(hand);
  hand.capsules[std::size_t(capsule_index(2, 2))].radius = 0.0;
  const DrawnHand part(hand);
  // Without the intermediate bone its cylinder and the ball at its end are gone; the last one gets its own.
  EXPECT_EQ(part.count(Marker::CYLINDER), whole.count(Marker::CYLINDER) - 1);
  EXPECT_EQ(part.count(Marker::SPHERE), whole.count(Marker::SPHERE));
}

TEST_F(MarkerShapes, what_touches_has_its_colour) {
  const Hand hand = complete_hand(adult_hand(Side::left), Pose{});
  Touching touching{};
  touching[std::size_t(capsule_index(1, 3))] = true;
  const DrawnHand drawn(hand, touching);
  int red = 0;
  for (const Marker& marker : drawn.array.markers) {
    if (marker.color.r < 0.9f) continue;
    ++red;
    EXPECT_EQ((marker.id - 200) / 3, capsule_index(1, 3));
  }
  EXPECT_EQ(red, 2);  // its cylinder and its end
}

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
    MarkerLayer layer{array, std_msgs::Header(), "shadows", 0.0};
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
