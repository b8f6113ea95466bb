#include <gtest/gtest.h>
#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mr_hand_interaction/ros/markers.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "support/fixtures.h"
#include "tracking/adult_hand.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;
using visualization_msgs::MarkerArray;

struct Shown {
  Shown()
      : scene(testing::scene_of(testing::box_body({0.05, 0.05, 0.05}, 0.1))), markers(scene, configuration) {
    scene.bodies.push_back(testing::ball_body(0.03, 0.1));
    scene.bodies.back().fixed = true;
    scene.bodies.back().visuals.push_back(
        {Mesh{nullptr, "package://some/mesh.stl", Vector3::Ones()}, {}, {}});
    for (const Body& body : scene.bodies) state.bodies.push_back(start_state(body));
    state.hands.resize(kMaxHands);
  }

  void see_hands(int count) {
    result.tracked.assign(static_cast<std::size_t>(count), complete_hand(adult_hand(Side::right), Pose{}));
    result.rendered.clear();
    for (const Hand& hand : result.tracked) result.rendered.push_back({hand, {}});
  }

  std::map<std::string, int> update() {
    std_msgs::Header header;
    header.frame_id = "world";
    array = markers.update(result, state, header);
    std::map<std::string, int> added;
    for (const Marker& marker : array.markers) added[marker.ns] += marker.action == Marker::ADD;
    return added;
  }

  long deleted(const std::string& layer) const {
    return std::count_if(array.markers.begin(), array.markers.end(), [&](const Marker& marker) {
      return marker.ns == layer && marker.action == Marker::DELETE;
    });
  }

  Configuration configuration;
  Scene scene;
  SimulationState state;
  FrameResult result;
  Markers markers;
  MarkerArray array;
};

bool is_unit(const geometry_msgs::Quaternion& q) {
  return std::abs(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w - 1.0) < 1e-9;
}

TEST(Markers, the_first_array_deletes_everything_before_it_and_later_ones_do_not) {
  Shown shown;
  shown.update();
  EXPECT_EQ(shown.array.markers.front().action, Marker::DELETEALL);
  shown.update();
  EXPECT_EQ(shown.array.markers.front().action, Marker::ADD);
  shown.markers.clear();
  shown.update();
  EXPECT_EQ(shown.array.markers.front().action, Marker::DELETEALL);
}

TEST(Markers, bodies_are_in_their_layers_also_without_visuals) {
  Shown shown;
  auto added = shown.update();
  EXPECT_EQ(added["objects"], 1);
  EXPECT_EQ(added["fixtures"], 1);
  EXPECT_EQ(added["text"], 1);
  EXPECT_EQ(added["hand"] + added["ghost"] + added["contacts"], 0);
  const auto mesh = std::find_if(shown.array.markers.begin(), shown.array.markers.end(),
                                 [](const Marker& marker) { return marker.type == Marker::MESH_RESOURCE; });
  ASSERT_NE(mesh, shown.array.markers.end());
  EXPECT_EQ(mesh->mesh_resource, "package://some/mesh.stl");
}

TEST(Markers, hands_that_go_are_deleted_and_ids_are_used_again) {
  Shown shown;
  shown.see_hands(2);
  auto added = shown.update();
  const int of_two = added["hand"];
  EXPECT_GT(of_two, 2 * kPhalanges);
  EXPECT_EQ(added["ghost"], of_two);
  shown.see_hands(1);
  added = shown.update();
  EXPECT_EQ(added["hand"], of_two / 2);
  EXPECT_EQ(shown.deleted("hand"), of_two / 2);
  EXPECT_EQ(shown.deleted("ghost"), of_two / 2);
  shown.update();
  EXPECT_EQ(shown.deleted("hand"), 0);
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

TEST(Markers, what_touches_is_highlighted) {
  Shown shown;
  shown.see_hands(1);
  shown.update();
  const auto before = shown.array;
  shown.result.rendered[0].touching[static_cast<std::size_t>(capsule_index(1, 3))] = true;
  shown.update();
  int changed = 0;
  for (const Marker& marker : shown.array.markers) {
    for (const Marker& old : before.markers) {
      if (marker.ns != "hand" || old.ns != marker.ns || old.id != marker.id) continue;
      changed += old.color.g != marker.color.g;
    }
  }
  EXPECT_EQ(changed, 2);  // the bone and its tip
}

TEST(Markers, arrows_end_at_the_contact_and_push_as_the_force_does) {
  Shown shown;
  Contact contact;
  contact.point = {0.1, 0.2, 0.3};
  contact.force = {0, 0, -1};
  shown.result.contacts = {contact};
  shown.update();
  const auto arrow = std::find_if(
      shown.array.markers.begin(), shown.array.markers.end(),
      [](const Marker& marker) { return marker.action == Marker::ADD && marker.type == Marker::ARROW; });
  ASSERT_NE(arrow, shown.array.markers.end());
  ASSERT_EQ(arrow->points.size(), 2u);
  EXPECT_EQ(arrow->points[1].z, 0.3);
  EXPECT_GT(arrow->points[0].z, 0.3);
}

}  // namespace
}  // namespace mrhi
