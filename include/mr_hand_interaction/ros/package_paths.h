#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/scene/scene_loader.h"

namespace mrhi {

/// Folders with this package's config, rviz, ...: relative to the executable's lib folder (installed), in the
/// build's source, or on the ROS package path. Needs no ROS master.
std::vector<std::string> share_folders();

/// Folders in which scenes are looked up by name.
std::vector<std::string> scene_folders();

/// Folders in which tasks are looked up by name.
std::vector<std::string> task_folders();

/// Turns "package://NAME/PATH" into a file path; empty if there is no such package.
std::string resolve_package_uri(const std::string& uri);

/// Options for loading a scene, from the configuration.
SceneOptions scene_options(const Configuration& configuration);

}  // namespace mrhi
