#include "ros/scene_view.h"

#include <map>
#include <set>
#include <utility>

#include "mr_hand_interaction/ros/package_paths.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "ros/result_messages.h"
#include "shown_markers.h"

namespace mrhi {
namespace {

using Key = std::pair<std::string, int>;

std::map<Key, Marker> by_key(const MarkerArray& array) {
  std::map<Key, Marker> markers;
  for (const Marker& marker : array.markers)
    if (marker.action == Marker::ADD) markers[{marker.ns, marker.id}] = marker;
  return markers;
}

double apart(const geometry_msgs::Point& a, const geometry_msgs::Point& b) {
  return std::hypot(std::hypot(a.x - b.x, a.y - b.y), a.z - b.z);
}

void expect_same(const Marker& a, const Marker& b) {
  constexpr double kFloat = 1e-6;  // radii are floats in messages [m]
  const std::string what = a.ns + " " + std::to_string(a.id);
  EXPECT_EQ(a.type, b.type) << what;
  EXPECT_EQ(a.text, b.text) << what;
  EXPECT_EQ(a.mesh_resource, b.mesh_resource) << what;
  EXPECT_LT(apart(a.pose.position, b.pose.position), kFloat) << what;
  EXPECT_NEAR(a.scale.x, b.scale.x, kFloat) << what;
  EXPECT_NEAR(a.color.a, b.color.a, 1e-5f) << what;
  ASSERT_EQ(a.points.size(), b.points.size()) << what;
  for (std::size_t i = 0; i < a.points.size(); ++i)
    ASSERT_LT(apart(a.points[i], b.points[i]), kFloat) << what;
  ASSERT_EQ(a.colors.size(), b.colors.size()) << what;
  for (std::size_t i = 0; i < a.colors.size(); ++i)
    ASSERT_NEAR(a.colors[i].g, b.colors[i].g, 1e-3f) << what;  // of light on normals of those places
}

TEST(SceneView, what_is_drawn_from_messages_is_what_the_node_draws) {
  Shown shown;
  shown.see_hands(2);
  shown.result.tracked[1].id = 12345;
  shown.result.rendered[1].hand.id = 12345;
  shown.state.hands[1].current.id = 12345;
  shown.state.hands[0].current.id = shown.result.rendered[0].hand.id;
  shown.result.tracked[0].capsules[static_cast<std::size_t>(capsule_index(1, 3))].end.z() -= 0.01;
  shown.state.bodies[0].pose.position = {0.1, 0.2, 0.3};
  shown.state.interactions.resize(kMaxHands * shown.scene.bodies.size());
  shown.state.interactions[0].level = InteractionLevel::grasp;
  for (const int capsule : {capsule_index(1, 3), kPalm}) {
    Contact contact;
    contact.key.hand = 1;
    contact.key.capsule = static_cast<std::uint8_t>(capsule);
    contact.point = shown.result.rendered[1].hand.capsules[static_cast<std::size_t>(capsule)].end;
    contact.radius = shown.result.rendered[1].hand.capsules[static_cast<std::size_t>(capsule)].radius;
    contact.depth = 0.004;
    contact.force = {0.3, 0.0, -2.0};
    contact.impulse = capsule == kPalm ? Vector3(0, 0, -0.05) : Vector3::Zero();
    shown.result.contacts.push_back(contact);
    auto& rendered = shown.result.rendered[1];
    rendered.touching[static_cast<std::size_t>(capsule)] = true;
    rendered.pressed[static_cast<std::size_t>(capsule)] = {2.0, contact.point};
  }
  shown.result.assists = {{0, 0, {0.0, 0.0, 1.5}}};
  shown.update();

  std_msgs::Header header;
  header.stamp = ros::Time(shown.now);
  SceneView view;
  view.take(scene_message(shown.scene, shown.configuration, header));
  const Outcome outcome{shown.scene, shown.result, shown.state};
  view.take(view_message(outcome, header));
  Markers markers(view.scene(), caption(view.model(), view.scene().gravity));
  MarkerArray array;
  markers.note(view.result(), header.stamp);
  markers.update(view.result(), view.state(), header, array);

  const auto here = by_key(shown.array), there = by_key(array);
  EXPECT_EQ(here.size(), there.size());
  for (const auto& [key, marker] : here) {
    EXPECT_EQ(there.count(key), 1u) << key.first << " " << key.second;
    if (there.count(key) == 0) continue;
    if (key.first != "text" && key.first != "shadows") expect_same(marker, there.at(key));
  }
  const Marker& text = there.at({"text", 0});
  EXPECT_EQ(text.text, here.at({"text", 0}).text);
  EXPECT_NE(text.text.find("holding: object (with grasp assist)"), std::string::npos) << text.text;
  std::set<std::string> layers;
  for (const auto& [key, marker] : there) layers.insert(key.first);
  EXPECT_EQ(layers,
            (std::set<std::string>{"capsules", "contacts", "fixtures", "forces", "friction", "ghost", "hand",
                                   "impacts", "newtons", "objects", "shadows", "share", "text"}));
}

TEST(SceneView, a_mesh_crosses_with_its_triangles_as_a_viewer_elsewhere_has_no_file) {
  const Scene scene = load_scene(find_scene_file("rack", scene_folders()), {});
  const auto message = scene_message(scene, {}, {});
  int meshes = 0;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    for (std::size_t i = 0; i < scene.bodies[b].visuals.size(); ++i) {
      const Mesh* const mesh = std::get_if<Mesh>(&scene.bodies[b].visuals[i].shape);
      if (!mesh) continue;
      ++meshes;
      const auto& shape = message.bodies[b].visuals[i];
      ASSERT_EQ(shape.triangles.size(), 3 * mesh->triangles->triangles.size());
      const auto& last = shape.vertices[shape.triangles.back()];
      const int vertex = mesh->triangles->triangles.back()[2];
      EXPECT_LT(
          (Vector3(last.x, last.y, last.z) - mesh->triangles->vertices[static_cast<std::size_t>(vertex)])
              .norm(),
          1e-6);
    }
  }
  EXPECT_GT(meshes, 0);
}

// A URDF without <visual> and colour, with an STL: rviz drew it with alpha 0.
TEST(SceneView, a_mesh_without_a_colour_is_as_opaque_as_in_the_node) {
  Scene scene = load_scene(find_scene_file("rack", scene_folders()), {});
  int meshes = 0;
  for (Body& body : scene.bodies)
    for (Visual& visual : body.visuals) visual.has_color = false, visual.rgba = Visual().rgba;
  SceneView view;
  view.take(scene_message(scene, {}, {}));
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    for (std::size_t i = 0; i < scene.bodies[b].visuals.size(); ++i) {
      const Mesh* const mesh = std::get_if<Mesh>(&view.scene().bodies[b].visuals[i].shape);
      if (!mesh) continue;
      ++meshes;
      EXPECT_EQ(view.scene().bodies[b].visuals[i].rgba, Visual().rgba);
      EXPECT_FALSE(view.scene().bodies[b].visuals[i].has_color);
      EXPECT_EQ(mesh->triangles->triangles,
                std::get<Mesh>(scene.bodies[b].visuals[i].shape).triangles->triangles);
    }
  }
  EXPECT_GT(meshes, 0);
}

TEST(SceneView, refuses_shapes_that_are_none_and_keeps_what_it_had) {
  Shown shown;
  auto message = scene_message(shown.scene, shown.configuration, {});
  SceneView view;
  view.take(message);
  for (const int wrong : {0, 1, 2}) {
    auto bad = message;
    auto& shape = bad.bodies[0].shapes[0];
    if (wrong == 0) shape.type = 9;
    if (wrong == 1) shape.size.pop_back();
    if (wrong == 2) shape.type = shape.MESH, shape.size.clear(), shape.triangles = {0, 1, 2};
    EXPECT_THROW(view.take(bad), std::invalid_argument);
    EXPECT_EQ(view.scene().bodies.size(), message.bodies.size());
  }
}

// 5 kB a frame and hand is what goes over a network.
TEST(SceneView, a_frame_of_one_hand_that_holds_with_five_fingers_is_less_than_5_kB) {
  Shown shown;
  shown.see_hands(1);
  for (int i = 0; i < 10; ++i) {
    shown.result.contacts.emplace_back();
    shown.result.contacts.back().key.capsule = static_cast<std::uint8_t>(capsule_index(i / 2, 3));
  }
  std_msgs::Header header;
  header.frame_id = "world";
  const auto bytes = [](const auto& message) { return ros::serialization::serializationLength(message); };
  EXPECT_LT(bytes(view_message({shown.scene, shown.result, shown.state}, header)), 5000u);
}

}  // namespace
}  // namespace mrhi
