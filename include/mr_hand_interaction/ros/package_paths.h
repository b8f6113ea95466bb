#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/scene/scene_loader.h"

namespace mrhi {

/// Where this package's config, rviz, ... are: beside the executable's lib folder (installed), where it was
/// built, or on the ROS package path. Needs no ROS master.
std::vector<std::string> share_folders();

/// Folders in which a scene's name is looked up.
std::vector<std::string> scene_folders();

/// Folders in which a task's name is looked up.
std::vector<std::string> task_folders();

/// "package://NAME/PATH" as the path of a file; empty if there is no such package.
std::string resolve_package_uri(const std::string& uri);

/// What loading a scene takes from the configuration.
SceneOptions scene_options(const Configuration& configuration);

}  // namespace mrhi
