#include "ros/scene_shapes.h"

#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "mr_hand_interaction/scene/scene_loader.h"

namespace mrhi {
namespace {

using visualization_msgs::Marker;

Scene shipped(const std::string& name) {
  return load_scene(find_scene_file(name, scene_folders()), {});
}

std::map<std::string, std::vector<Marker>> by_body(const Scene& scene) {
  std::map<std::string, std::vector<Marker>> markers;
  for (const Marker& marker : scene_shapes(scene, {}, "map").markers) markers[marker.ns].push_back(marker);
  return markers;
}

TEST(SceneShapes, every_body_has_its_visuals_once_free_ones_in_their_own_frame) {
  for (const char* const name : {"rack", "panel", "mixed"}) {
    const Scene scene = shipped(name);
    auto markers = by_body(scene);
    EXPECT_EQ(markers.size(), scene.bodies.size() + 1) << "and a text";
    for (const Body& body : scene.bodies) {
      ASSERT_FALSE(body.visuals.empty());
      ASSERT_EQ(markers[body.name].size(), body.visuals.size());
      for (std::size_t i = 0; i < body.visuals.size(); ++i) {
        const Marker& marker = markers[body.name][i];
        EXPECT_EQ(marker.header.frame_id, body.fixed ? "map" : body.name);
        const Pose place = body.fixed ? body.start * body.visuals[i].pose : body.visuals[i].pose;
        EXPECT_EQ(from_message(marker.pose).position, place.position);
        EXPECT_EQ(marker.color.r, body.visuals[i].rgba[0]);
        EXPECT_TRUE(marker.colors.empty()) << "light would be painted on";
      }
    }
  }
}

TEST(SceneShapes, a_mesh_comes_by_its_triangles) {
  const Scene scene = shipped("rack");
  int meshes = 0;
  auto markers = by_body(scene);
  for (const Body& body : scene.bodies) {
    for (std::size_t i = 0; i < body.visuals.size(); ++i) {
      const Mesh* const mesh = std::get_if<Mesh>(&body.visuals[i].shape);
      if (!mesh) continue;
      ++meshes;
      const Marker& marker = markers[body.name][i];
      ASSERT_EQ(marker.type, Marker::TRIANGLE_LIST);
      EXPECT_TRUE(marker.mesh_resource.empty()) << "a viewer on another machine has no such file";
      ASSERT_EQ(marker.points.size(), 3 * mesh->triangles->triangles.size());
      const int last = mesh->triangles->triangles.back()[2];
      EXPECT_EQ(from_message(marker.points.back()),
                mesh->triangles->vertices[static_cast<std::size_t>(last)]);
    }
  }
  EXPECT_GT(meshes, 0);
}

TEST(SceneShapes, a_body_without_visuals_shows_what_collides) {
  Scene scene = shipped("cube");
  scene.bodies.front().visuals.clear();
  EXPECT_EQ(by_body(scene)[scene.bodies.front().name].size(), scene.bodies.front().shapes.size());
}

}  // namespace
}  // namespace mrhi
