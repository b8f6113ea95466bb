#include "mr_hand_interaction/scene/scene_loader.h"

#include <algorithm>
#include <filesystem>

#include "scene_yaml.h"
#include "text.h"
#include "urdf_scene.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

bool is_file(const fs::path& path) {
  std::error_code ignored;
  return fs::is_regular_file(path, ignored);
}

std::vector<std::string> scene_names(const std::vector<std::string>& directories) {
  std::vector<std::string> names;
  for (const std::string& directory : directories) {
    std::error_code ignored;
    for (const fs::directory_entry& entry : fs::directory_iterator(directory, ignored)) {
      if (entry.path().extension() == ".urdf") names.push_back(entry.path().stem().string());
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

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
  const bool is_path = scene.find('/') != std::string::npos || fs::path(scene).extension() == ".urdf";
  if (is_path) {
    if (is_file(scene)) return scene;
    throw SceneError("scene file '" + scene + "' does not exist; allowed: a URDF file, or one of " +
                     text::joined(scene_names(directories)));
  }
  for (const std::string& directory : directories) {
    const fs::path file = fs::path(directory) / (scene + ".urdf");
    if (is_file(file)) return file.string();
  }
  throw SceneError("unknown scene '" + scene + "'; allowed: a URDF file, or one of " +
                   text::joined(scene_names(directories)));
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
