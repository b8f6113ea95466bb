#include "mr_hand_interaction/scene/scene_loader.h"

#include <filesystem>

#include "../collision/overlap.h"
#include "../text/file_text.h"
#include "../text/text.h"
#include "scene_yaml.h"
#include "urdf.h"

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

/// Bounds that no file gives hold all that moves where it starts.
void widen_bounds(Scene& scene) {
  constexpr double kRoom = 1.0;  // [m]
  Bounds wide = scene.bounds;
  for (const Body& body : scene.bodies) {
    if (body.fixed) continue;
    const Vector3 room = Vector3::Constant(kRoom + body.bounding_radius), &start = body.start.position;
    if ((start.array() >= scene.bounds.min.array()).all() &&
        (start.array() <= scene.bounds.max.array()).all())
      continue;
    wide.min = wide.min.cwiseMin(start - room), wide.max = wide.max.cwiseMax(start + room);
  }
  if (wide.min == scene.bounds.min && wide.max == scene.bounds.max) return;
  scene.bounds = wide;
  scene.warnings.push_back(
      "bodies start out of the usual bounds, which are widened: " + text::vector(wide.min) + " to " +
      text::vector(wide.max) + " m; the YAML's 'bounds' sets others");
}

/// Bodies that begin inside each other push each other out with all they have, and many of them at once cost
/// more than a step has time for.
void check_overlaps(const std::string& file, const Scene& scene) {
  const std::string overlaps = overlaps_at_start(scene);
  if (overlaps.empty()) return;
  throw SceneError(file + ": " + text::one_line(overlaps, 400) + "; allowed: at most " +
                   text::number(kOverlap) + " m");
}

}  // namespace

SceneError::SceneError(const std::string& message) : std::runtime_error(text::one_line(message, 4000)) {}

std::string find_scene_file(const std::string& scene, const std::vector<std::string>& directories) {
  return find_named_file("scene", scene, ".urdf", directories);
}

Scene load_scene(const std::string& urdf_file, const SceneOptions& options) {
  Scene scene;
  scene.name = fs::path(urdf_file).stem().string();
  read_urdf(urdf_file, options, scene);
  const Bounds usual = scene.bounds;
  const fs::path settings = fs::path(urdf_file).replace_extension(".yaml");
  if (fs::exists(settings)) apply_scene_yaml(settings.string(), scene);
  if (options.gravity) scene.gravity = *options.gravity;
  try {
    arrange_joints(scene);
  } catch (const std::invalid_argument& error) {
    throw SceneError(urdf_file + ": " + text::one_line(error.what()));
  }
  if (usual.min == scene.bounds.min && usual.max == scene.bounds.max) widen_bounds(scene);
  check_starts_in_bounds(urdf_file, scene);
  check_overlaps(urdf_file, scene);
  return scene;
}

}  // namespace mrhi
