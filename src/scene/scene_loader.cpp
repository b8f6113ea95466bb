#include "mr_hand_interaction/scene/scene_loader.h"

#include <filesystem>

#include "named_file.h"
#include "scene_yaml.h"
#include "text.h"
#include "urdf_scene.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

void check_starts_in_bounds(const std::string& file, const Scene& scene) {
  for (const Body& body : scene.bodies) {
    const Vector3& start = body.start.position;
    const bool inside = (start.array() >= scene.bounds.min.array()).all() &&
                        (start.array() <= scene.bounds.max.array()).all();
    if (body.fixed || inside) continue;
    throw SceneError(file + ": body '" + body.name + "': start " + text::vector(start) +
                     " m is out of bounds; allowed: " + text::vector(scene.bounds.min) + " to " +
                     text::vector(scene.bounds.max));
  }
}

}  // namespace

std::string find_scene_file(const std::string& scene, const std::vector<std::string>& directories) {
  return find_named_file("scene", scene, ".urdf", directories);
}

Scene load_scene(const std::string& urdf_file, const SceneOptions& options) {
  Scene scene;
  scene.name = fs::path(urdf_file).stem().string();
  scene.bodies = read_bodies(urdf_file, options);
  const fs::path settings = fs::path(urdf_file).replace_extension(".yaml");
  if (fs::exists(settings)) apply_scene_yaml(settings.string(), scene);
  if (options.gravity) scene.gravity = *options.gravity;
  check_starts_in_bounds(urdf_file, scene);
  return scene;
}

}  // namespace mrhi
