#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/input_error.h"
#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// Error of a scene that cannot be loaded.
using SceneError = InputError;

/// Inputs of a loader besides the files.
struct SceneOptions {
  Material default_material;
  std::optional<Vector3> gravity;  ///< overrides the scene's [m/s^2]
  /// Turns "package://NAME/PATH" into a file path; returns an empty string if the package is not found.
  std::function<std::string(const std::string& uri)> resolve_package_uri;
  double density = 1000.0;  ///< of bodies without a mass [kg/m^3]
  /// Replacement files for mesh names of a URDF, which take precedence.
  std::map<std::string, std::string> mesh_files{};
  /// Asked ten times a second while meshes are read; once it is true, loading throws SceneError.
  std::function<bool()> is_cancelled{};
};

/// Finds a scene's URDF file: `scene` is a path to a URDF, or a name looked up as DIRECTORY/NAME.urdf. Throws
/// SceneError that lists the known names.
std::string find_scene_file(const std::string& scene, const std::vector<std::string>& directories);

/// Reads FILE.urdf, and FILE.yaml beside it if present. Links on `floating` joints are free bodies, with the
/// joint's origin as the link's pose. Links on `fixed` joints to `world` are fixtures. Links on `revolute`,
/// `continuous` and `prismatic` joints are children of the joint's parent. Throws SceneError, also if bodies
/// overlap at the start, unless a joint connects them.
Scene load_scene(const std::string& urdf_file, const SceneOptions& options);

}  // namespace mrhi
