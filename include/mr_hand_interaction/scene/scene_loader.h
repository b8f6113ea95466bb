#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/input_error.h"
#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// A scene that cannot be loaded.
using SceneError = InputError;

/// What a loader needs beside the files themselves.
struct SceneOptions {
  Material default_material;
  std::optional<Vector3> gravity;  ///< overrides the scene's own [m/s^2]
  /// Turns "package://NAME/PATH" into a file path; empty result: package not found.
  std::function<std::string(const std::string& uri)> resolve_package_uri;
  double density = 1000.0;  ///< of bodies without a mass [kg/m^3]
  /// Files to read for the meshes that a URDF names so, before anything else is looked for.
  std::map<std::string, std::string> mesh_files{};
};

/// The URDF file that `scene` means: a path to a URDF, or a name looked up as DIRECTORY/NAME.urdf.
/// Throws SceneError that lists the names known.
std::string find_scene_file(const std::string& scene, const std::vector<std::string>& directories);

/// Reads FILE.urdf, and FILE.yaml beside it where present: links on `floating` joints are free bodies (the
/// joint's origin is the link's pose), links on `fixed` joints to `world` are fixtures, links on `revolute`,
/// `continuous` and `prismatic` joints hang on what their joints join them to. Throws SceneError; also for
/// bodies that begin inside each other, unless a joint joins them.
Scene load_scene(const std::string& urdf_file, const SceneOptions& options);

}  // namespace mrhi
