#include "shown_markers.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "ros/marker_layers.h"

namespace mrhi {
namespace {

bool is_unit(const geometry_msgs::Quaternion& q) {
  return std::abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1.0) < 1e-9;
}

TEST(Markers, the_first_array_deletes_everything_before_it_and_later_ones_do_not) {
  Shown shown;
  shown.update();
  EXPECT_EQ(shown.array.markers.front().action, Marker::DELETEALL);
  shown.see_hands(1);
  shown.update();
  EXPECT_EQ(shown.array.markers.front().action, Marker::ADD);
  shown.markers.clear();
  shown.update();
  EXPECT_EQ(shown.array.markers.front().action, Marker::DELETEALL);
}

TEST(Markers, what_stays_as_it_is_is_sent_again_twice_a_second_and_to_who_comes_later) {
  Shown shown;
  EXPECT_EQ(shown.update()["objects"], 1);
  shown.now += 0.1;
  auto added = shown.update();
  EXPECT_EQ(added["objects"] + added["fixtures"] + added["text"], 0);
  for (const bool later : {true, false}) {
    if (later) shown.markers.send_all();
    shown.now += later ? 0.1 : 0.5;
    added = shown.update();
    EXPECT_EQ(added["objects"], 1);
    EXPECT_EQ(added["fixtures"], 1);
    EXPECT_EQ(added["text"], 1);
  }
  EXPECT_EQ(shown.array.markers.front().action, Marker::ADD);
}

TEST(Markers, shadows_are_sent_of_what_moves) {
  Shown shown;
  shown.state.bodies[0].pose.position = Vector3(0.0, 0.0, 0.2);
  shown.see_hands(1);
  EXPECT_EQ(shown.update()["shadows"], 2);
  shown.now += 0.1;
  EXPECT_EQ(shown.update()["shadows"], 0);
  shown.state.bodies[0].pose.position.x() += 0.001;
  EXPECT_EQ(shown.update()["shadows"], 1);
  shown.see_hands(0);
  shown.update();
  EXPECT_EQ(shown.deleted("shadows"), 1);
}

TEST(Markers, an_impact_is_a_ring_that_widens_and_fades_within_150_ms_and_is_not_lost_between_pictures) {
  Shown shown;
  shown.update();
  Contact contact;
  contact.radius = 0.008;
  contact.impulse = {0.0, 0.0, -0.02};
  shown.result.contacts = {contact};
  shown.markers.note(shown.result, ros::Time(shown.now += 0.008));
  shown.result.contacts.clear();
  double radius = 0.0;
  float alpha = 1.01f;
  for (int picture = 0; picture < 3; ++picture) {  // 40 ms apart: at 40, 80 and 120 ms
    ASSERT_EQ(shown.update()["impacts"], 1);
    const Marker& ring = shown.first("impacts");
    const double now = std::hypot(ring.points[0].x, ring.points[0].y);
    EXPECT_GT(now, radius);
    EXPECT_LT(ring.colors[0].a, alpha);
    radius = now, alpha = ring.colors[0].a;
  }
  EXPECT_EQ(shown.update()["impacts"], 0);
  EXPECT_EQ(shown.deleted("impacts"), 1);
}

TEST(Markers, what_moves_is_sent_at_once_and_alone) {
  Shown shown;
  shown.scene.bodies.push_back(testing::ball_body(0.02, 0.1));
  shown.state.bodies.push_back(start_state(shown.scene.bodies.back()));
  shown.update();
  shown.state.bodies[2].pose.position.x() += 1e-6;
  EXPECT_EQ(shown.update()["objects"], 1);
  EXPECT_EQ(shown.first("objects").id, 1);
  EXPECT_EQ(shown.first("objects").pose.position.x, shown.state.bodies[2].pose.position.x());
  EXPECT_EQ(shown.update()["objects"], 0);
}

TEST(Markers, memory_serves_again) {
  Shown shown;
  shown.see_hands(1);
  shown.update();
  shown.update();
  const auto* points = shown.first("hand").points.data();
  shown.update();
  EXPECT_EQ(shown.first("hand").points.data(), points);
}

TEST(Markers, keys_are_unique_and_quaternions_unit) {
  Shown shown;
  shown.see_hands(4);
  Contact contact;
  contact.force = {0, 0, -1};
  shown.result.contacts = {contact, contact};
  shown.update();
  std::set<std::pair<std::string, int>> keys;
  for (const Marker& marker : shown.array.markers) {
    if (marker.action != Marker::ADD) continue;
    EXPECT_TRUE(keys.emplace(marker.ns, marker.id).second) << marker.ns << " " << marker.id;
    EXPECT_TRUE(is_unit(marker.pose.orientation)) << marker.ns << " " << marker.id;
    EXPECT_EQ(marker.header.frame_id, "world");
  }
}

TEST(TargetMarks, show_the_object_translucent_where_it_is_to_be_and_a_ring_that_fills) {
  const Body body = testing::box_body({0.05, 0.05, 0.05}, 0.1);
  const Pose pose{Vector3(0.1, 0.2, 0.3), Quaternion::Identity()};
  std::size_t before = 0;
  for (const double progress : {0.0, 0.3, 1.0}) {
    MarkerArray array;
    MarkerLayer layer{array, std_msgs::Header(), "targets", 0.0};
    add_target({body, pose, progress, false}, 5, layer);
    ASSERT_EQ(array.markers.size(), 2u);
    EXPECT_EQ(array.markers[0].id, 5);
    EXPECT_EQ(from_message(array.markers[0].pose.position), pose.position);
    EXPECT_LT(array.markers[0].color.a, 0.5f);
    const auto& ring = array.markers[1];
    ASSERT_EQ(ring.points.size(), ring.colors.size());
    const auto filled = static_cast<std::size_t>(std::count_if(
        ring.colors.begin(), ring.colors.end(), [](const std_msgs::ColorRGBA& c) { return c.a == 1.0f; }));
    EXPECT_NEAR(static_cast<double>(filled) / static_cast<double>(ring.points.size()), progress, 0.05);
    EXPECT_GE(filled, before);
    before = filled;
    for (const auto& point : ring.points)
      EXPECT_GT((from_message(point) - pose.position).norm(), body.bounding_radius);
  }
}

TEST(TargetMarks, that_are_reached_have_another_colour) {
  const Body body = testing::ball_body(0.03, 0.1);
  MarkerArray array;
  MarkerLayer layer{array, std_msgs::Header(), "targets", 0.0};
  add_target({body, Pose{}, 0.5, false}, 0, layer);
  add_target({body, Pose{}, 0.5, true}, 10, layer);
  EXPECT_NE(array.markers.front().color.b, array.markers[2].color.b);
}

TEST(Markers, the_text_is_under_everything_and_under_the_hands_where_bodies_are_high) {
  for (const auto& [lowest, text] : {std::pair(-0.5, -0.63), std::pair(2.0, 0.05)}) {
    Shown shown;
    for (Body& body : shown.scene.bodies) body.start.position.z() = 2.0;
    shown.scene.bodies[1].start.position.z() = lowest;
    Markers markers(shown.scene, shown.configuration);
    markers.update(shown.result, shown.state, std_msgs::Header(), shown.array);
    EXPECT_NEAR(shown.first("text").pose.position.z, text, 1e-9);
  }
}

}  // namespace
}  // namespace mrhi
