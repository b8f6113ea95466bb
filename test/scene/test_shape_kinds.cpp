#include "scene/shape_kinds.h"

#include <gtest/gtest.h>

#include "mr_hand_interaction/scene/save_scene.h"
#include "scene/scene_files.h"

namespace mrhi {
namespace {

/// Of 10, 20, ... cm.
Shape of_kind(const ShapeKind& kind) {
  std::vector<double> sizes;
  for (std::size_t i = 0; i < kind.sizes.size(); ++i) sizes.push_back(0.1 * static_cast<double>(i + 1));
  return kind.make(sizes);
}

TEST(ShapeKinds, tell_the_sizes_of_their_own_shapes_and_of_no_other) {
  for (const ShapeKind& kind : shape_kinds()) {
    for (const ShapeKind& asked : shape_kinds()) {
      const auto sizes = asked.sizes_of(of_kind(kind));
      ASSERT_EQ(sizes.has_value(), asked.name == kind.name) << kind.name << " by " << asked.name;
      for (std::size_t i = 0; sizes && i < sizes->size(); ++i)
        EXPECT_DOUBLE_EQ((*sizes)[i], 0.1 * static_cast<double>(i + 1)) << kind.name;
    }
  }
}

TEST(ShapeKinds, are_saved_and_loaded_with_their_sizes) {
  Scene scene = load_scene("config/scenes/cube.urdf", {});
  const Body cube = scene.bodies[0];
  scene.bodies.clear();
  for (const ShapeKind& kind : shape_kinds()) {
    Body body = cube;
    body.name = kind.name;
    body.shapes = {{of_kind(kind), {}}};
    body.visuals.clear();
    body.start.position.x() = 0.8 * static_cast<double>(scene.bodies.size()) - 1.2;
    complete(body);
    scene.bodies.push_back(body);
  }
  const test::Folder folder;
  const std::string file = folder.path() + "/kinds.urdf";
  save_scene(scene, file);
  const Scene loaded = load_scene(file, {});
  for (const ShapeKind& kind : shape_kinds()) {
    const auto found = find_body(loaded, kind.name);
    ASSERT_TRUE(found) << kind.name;
    const auto sizes = kind.sizes_of(loaded.bodies[static_cast<std::size_t>(*found)].shapes[0].shape);
    ASSERT_TRUE(sizes) << kind.name;
    EXPECT_EQ(*sizes, *kind.sizes_of(of_kind(kind))) << kind.name;
  }
}

}  // namespace
}  // namespace mrhi
