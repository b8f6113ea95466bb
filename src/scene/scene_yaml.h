#pragma once

#include <string>

#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// Sets gravity, bounds and materials of a scene whose bodies are known, from its YAML file. A material keeps
/// what the file does not name. Throws SceneError.
void apply_scene_yaml(const std::string& yaml_file, Scene& scene);

}  // namespace mrhi
