#include "shown_markers.h"

#include <algorithm>
#include <vector>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"

namespace mrhi {
namespace {

TEST(BodyMarkers, bodies_are_in_their_layers_also_without_visuals) {
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

TEST(BodyMarkers, an_object_with_a_finger_deep_inside_lets_the_ghost_be_seen) {
  Shown shown;
  shown.update();
  float before = 1.0f;
  for (const double depth : {0.005, 0.008, 0.012, 0.1}) {
    Contact contact;
    contact.key.body = 0;
    contact.depth = depth;
    shown.result.contacts = {contact};
    const bool deep = depth > 0.006;
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

TEST(BodyMarkers, a_mesh_stays_opaque_as_viewers_do_not_sort_its_triangles) {
  Shown shown;
  shown.scene.bodies[0].visuals = {shown.scene.bodies[1].visuals};
  Contact contact;
  contact.depth = 0.1;
  shown.result.contacts = {contact};
  shown.update();
  EXPECT_EQ(shown.first("objects").type, Marker::MESH_RESOURCE);
  EXPECT_EQ(shown.first("objects").color.a, 1.0f);
}

TEST(BodyMarkers, no_side_of_a_box_is_dark_and_its_top_is_lightest) {
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

TEST(BodyMarkers, a_mesh_without_a_color_keeps_the_materials_of_its_file) {
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

}  // namespace
}  // namespace mrhi
