#pragma once

#include <string>

#include "../text/yaml.h"
#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// Sets gravity, bounds, materials, twists and joints of a scene whose bodies and joints are known, from its
/// YAML file. A material keeps what the file does not name. Throws SceneError.
void apply_scene_yaml(const std::string& yaml_file, Scene& scene);

/// Sets joints from the text of such a file's entry, likewise.
void apply_joints_yaml(const std::string& source, const std::string& yaml, Scene& scene);

/// Sets a body's material from the text of such a file's entry; `source` names it in messages. Throws
/// SceneError.
void apply_material_yaml(const std::string& source, const std::string& yaml, Body& body);

}  // namespace mrhi
