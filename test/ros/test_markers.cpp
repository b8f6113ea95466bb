#include <gtest/gtest.h>
#include <visualization_msgs/Marker.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "mr_hand_interaction/rendering/skin.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/markers.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "ros/marker_layers.h"
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

  void see_hands(int count, Side side = Side::right) {
    result.tracked.assign(static_cast<std::size_t>(count), complete_hand(adult_hand(side), Pose{}));
    result.rendered.clear();
    for (const Hand& hand : result.tracked) result.rendered.push_back({hand, {}});
  }

  std::map<std::string, int> update() {
    std_msgs::Header header;
    header.frame_id = "world";
    header.stamp = ros::Time(now += 0.04);  // enough for what is not in a hurry
    markers.update(result, state, header, array);
    MarkerArray rest;
    markers.update_rest(result, state, header, rest);
    array.markers.insert(array.markers.end(), rest.markers.begin(), rest.markers.end());
    std::map<std::string, int> added;
    for (const Marker& marker : array.markers) added[marker.ns] += marker.action == Marker::ADD;
    return added;
  }

  /// The first marker of a layer.
  const Marker& first(const std::string& layer) const {
    static const Marker none;
    for (const Marker& marker : array.markers) {
      if (marker.ns == layer && marker.action == Marker::ADD) return marker;
    }
    ADD_FAILURE() << "nothing in " << layer;
    return none;
  }

  long deleted(const std::string& layer) const {
    return std::count_if(array.markers.begin(), array.markers.end(), [&](const Marker& marker) {
      return marker.ns == layer && marker.action == Marker::DELETE;
    });
  }

  double now = 100.0;  // [s]
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
  shown.see_hands(1);
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
  EXPECT_EQ(added["hand"] + added["ghost"] + added["capsules"] + added["contacts"], 0);
  const auto mesh = std::find_if(shown.array.markers.begin(), shown.array.markers.end(),
                                 [](const Marker& marker) { return marker.type == Marker::MESH_RESOURCE; });
  ASSERT_NE(mesh, shown.array.markers.end());
  EXPECT_EQ(mesh->mesh_resource, "package://some/mesh.stl");
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

TEST(Markers, capsules_and_text_come_thirty_times_a_second) {
  Shown shown;
  shown.see_hands(1);
  shown.update();
  std_msgs::Header header;
  MarkerArray rest;
  int arrays = 0;
  for (int frame = 0; frame < 120; ++frame) {
    header.stamp = ros::Time(shown.now + (frame + 1) / 120.0);
    shown.markers.update_rest(shown.result, shown.state, header, rest);
    arrays += !rest.markers.empty();
  }
  EXPECT_NEAR(arrays, 30, 6);
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

TEST(Markers, an_object_with_a_finger_deep_inside_lets_the_ghost_be_seen) {
  Shown shown;
  shown.update();
  float before = 1.0f;
  for (const double depth : {0.0015, 0.004, 0.006, 0.1}) {
    Contact contact;
    contact.key.body = 0;
    contact.depth = depth;
    shown.result.contacts = {contact};
    const bool deep = depth > 0.002;
    EXPECT_EQ(shown.update()["objects"], deep);
    if (!deep) continue;
    const float opacity = shown.first("objects").colors.at(0).a;
    EXPECT_LT(opacity, before);
    EXPECT_GT(opacity, 0.5f);
    before = opacity;
  }
  shown.result.contacts.clear();
  EXPECT_EQ(shown.update()["objects"], 1);
  EXPECT_EQ(shown.first("objects").colors.at(0).a, 1.0f);
}

TEST(Markers, no_side_of_a_box_is_dark_and_its_top_is_lightest) {
  Shown shown;
  shown.update();
  const Marker& box = shown.first("objects");
  ASSERT_EQ(box.points.size(), 36u);
  ASSERT_EQ(box.colors.size(), 36u);
  double top = 0.0, others = 0.0;
  for (std::size_t i = 0; i < 36; i += 6) {
    Vector3 middle = Vector3::Zero();
    for (std::size_t corner = i; corner < i + 6; ++corner) middle += from_message(box.points[corner]) / 6.0;
    EXPECT_GT(box.colors[i].g, 0.35f);  // of 0.7
    (middle.z() > 0.4 ? top : others) = std::max<double>(middle.z() > 0.4 ? top : others, box.colors[i].g);
    const Vector3 a = from_message(box.points[i]), b = from_message(box.points[i + 1]),
                  c = from_message(box.points[i + 2]);
    EXPECT_GT((b - a).cross(c - a).dot(middle), 0.0);  // counter-clockwise from outside
  }
  EXPECT_GT(top, others);
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

TEST(Markers, a_hand_is_one_skin_and_hands_that_go_are_deleted) {
  Shown shown;
  shown.see_hands(2);
  auto added = shown.update();
  EXPECT_EQ(added["hand"], 2);
  const int capsules = added["capsules"];
  EXPECT_GT(capsules, 2 * kPhalanges);
  const Marker& skin = shown.first("hand");
  EXPECT_EQ(skin.type, Marker::TRIANGLE_LIST);
  EXPECT_EQ(skin.points.size(), 3 * Skin::human().triangles().size());
  EXPECT_EQ(skin.colors.size(), skin.points.size());
  shown.see_hands(1);
  added = shown.update();
  EXPECT_EQ(added["hand"], 1);
  EXPECT_EQ(shown.deleted("hand"), 1);
  EXPECT_EQ(shown.deleted("capsules"), capsules / 2);
  shown.update();
  EXPECT_EQ(shown.deleted("hand"), 0);
}

TEST(Markers, triangles_of_either_hand_are_counter_clockwise_from_outside) {
  for (const Side side : {Side::left, Side::right}) {
    Shown shown;
    shown.see_hands(1, side);
    shown.update();
    const auto& points = shown.first("hand").points;
    double six_volumes = 0.0;
    for (std::size_t i = 0; i < points.size(); i += 3) {
      six_volumes +=
          from_message(points[i]).dot(from_message(points[i + 1]).cross(from_message(points[i + 2])));
    }
    EXPECT_GT(six_volumes, 0.0);
  }
}

TEST(Markers, a_hand_with_a_bone_missing_is_drawn_as_capsules) {
  Shown shown;
  shown.see_hands(1);
  shown.result.rendered[0].hand.capsules[static_cast<std::size_t>(capsule_index(3, 2))] = {};
  const auto added = shown.update();
  EXPECT_EQ(added.at("hand"), added.at("capsules"));
  EXPECT_GT(added.at("hand"), kPhalanges);
}

TEST(Markers, the_ghost_is_seen_where_the_tracked_hand_is_elsewhere_and_more_so_the_farther) {
  Shown shown;
  shown.see_hands(1);
  EXPECT_EQ(shown.update()["ghost"], 0);
  const auto tip = static_cast<std::size_t>(capsule_index(1, 3));
  float before = 0.0f;
  for (const double shift : {0.0005, 0.003, 0.006}) {
    shown.result.tracked[0] = shown.result.rendered[0].hand;
    shown.result.tracked[0].capsules[tip].end.z() -= shift;
    const bool seen = shift > 0.001;
    ASSERT_EQ(shown.update()["ghost"], seen);
    if (!seen) continue;
    const Marker& ghost = shown.first("ghost");
    EXPECT_LT(ghost.points.size(), shown.first("hand").points.size() / 10);  // the fingertip alone
    float most = 0.0f;
    for (const auto& color : ghost.colors) most = std::max(most, color.a);
    EXPECT_GT(most, before);
    before = most;
  }
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
  const auto before = shown.first("hand").colors;
  const int touching = capsule_index(1, 3);
  shown.result.rendered[0].touching[static_cast<std::size_t>(touching)] = true;
  shown.update();
  const auto& after = shown.first("hand").colors;
  int changed = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const auto vertex =
        static_cast<std::size_t>(Skin::human().triangles()[i / 3][i % 3]);  // a right hand: the same order
    if (after[i].g == before[i].g) continue;
    EXPECT_GT(Skin::human().share(vertex, touching), 0.3f);
    ++changed;
  }
  EXPECT_GT(changed, 100);
}

TEST(Markers, the_light_on_a_hand_is_that_of_the_frame_before_and_a_still_hand_keeps_it) {
  Shown shown;
  shown.see_hands(1);
  const auto colours = [&] {
    shown.update();
    return shown.first("hand").colors;
  };
  const auto open = colours();
  EXPECT_EQ(colours(), open);
  const Pose turned{Vector3::Zero(), Quaternion(Eigen::AngleAxisd(M_PI, Vector3::UnitX()))};
  shown.result.rendered[0].hand = complete_hand(adult_hand(Side::right), turned);
  shown.result.tracked[0] = shown.result.rendered[0].hand;
  EXPECT_EQ(colours(), open);
  const auto over = colours();
  EXPECT_NE(over, open);
  EXPECT_EQ(colours(), over);
}

TEST(Markers, arrows_push_as_the_force_does_behind_the_finger_and_are_longer_for_more) {
  Shown shown;
  Contact contact;
  contact.point = {0.1, 0.2, 0.3};
  contact.radius = 0.01;
  double before = 0.0;
  for (const double newtons : {0.2, 1.0, 5.0, 100.0}) {
    contact.force = {0, 0, -newtons};
    shown.result.contacts = {contact};
    shown.update();
    const Marker& arrow = shown.first("forces");
    ASSERT_EQ(arrow.points.size(), 2u);
    EXPECT_GT(arrow.points[1].z, contact.point.z() + 2.0 * contact.radius);
    const double length = arrow.points[0].z - arrow.points[1].z;
    EXPECT_GT(length, before);
    EXPECT_LT(length, 0.1);
    before = length;
  }
}

TEST(Markers, sticking_slipping_and_striking_differ_in_colour) {
  Shown shown;
  Contact contact;
  contact.radius = 0.01;
  const auto ring = [&] {
    shown.result.contacts = {contact};
    shown.update();
    EXPECT_EQ(shown.first("contacts").points.size(), 1u);
    const auto c = shown.first("friction").colors.at(0);
    return std::array<float, 3>{c.r, c.g, c.b};
  };
  const auto sticking = ring();
  contact.friction = Friction::slipping;
  const auto slipping = ring();
  contact.impulse = Vector3::UnitX();
  const auto striking = ring();
  EXPECT_NE(sticking, slipping);
  EXPECT_NE(slipping, striking);
  EXPECT_GT(slipping[0] + slipping[1],
            sticking[0] + sticking[1] + 0.5f);  // also where hues are not told apart
}

TEST(Markers, a_mesh_without_a_color_keeps_the_materials_of_its_file) {
  Shown shown;
  Visual plain{Mesh{nullptr, "package://some/mesh.dae", Vector3::Ones()}, {}}, painted = plain;
  painted.has_color = true;
  shown.scene.bodies[0].visuals = {plain, painted};
  shown.update();
  std::vector<const Marker*> meshes;
  for (const Marker& marker : shown.array.markers) {
    if (marker.ns == "objects" && marker.action == Marker::ADD) meshes.push_back(&marker);
  }
  ASSERT_EQ(meshes.size(), 2u);
  EXPECT_TRUE(meshes[0]->mesh_use_embedded_materials);
  EXPECT_EQ(meshes[0]->color.a, 0.0f);
  EXPECT_FALSE(meshes[1]->mesh_use_embedded_materials);
  EXPECT_EQ(meshes[1]->color.a, 1.0f);
}

TEST(TargetMarks, show_the_object_translucent_where_it_is_to_be_and_a_ring_that_fills) {
  const Body body = testing::box_body({0.05, 0.05, 0.05}, 0.1);
  const Pose pose{Vector3(0.1, 0.2, 0.3), Quaternion::Identity()};
  std::size_t before = 0;
  for (const double progress : {0.0, 0.3, 1.0}) {
    MarkerArray array;
    MarkerLayer layer(array, std_msgs::Header(), "targets", 0.0);
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
  MarkerLayer layer(array, std_msgs::Header(), "targets", 0.0);
  add_target({body, Pose{}, 0.5, false}, 0, layer);
  add_target({body, Pose{}, 0.5, true}, 10, layer);
  EXPECT_NE(array.markers.front().color.b, array.markers[2].color.b);
}

TEST(Markers, the_text_is_under_everything) {
  Shown shown;
  shown.scene.bodies[1].start.position.z() = -0.5;
  Markers markers(shown.scene, shown.configuration);
  MarkerArray array;
  markers.update_rest(shown.result, shown.state, std_msgs::Header(), array);
  for (const Marker& marker : array.markers) {
    if (marker.ns != "text") continue;
    EXPECT_LT(marker.pose.position.z, -0.53);
  }
}

}  // namespace
}  // namespace mrhi
