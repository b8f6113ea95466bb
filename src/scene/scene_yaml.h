#pragma once

#include <string>

#include "../text/yaml_values.h"
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

/// Sets of joints, by their names, what a URDF has no place for. What the numbers may be is
/// arrange_joints()'s to say. Throws YamlError.
void read_joint_settings(const YamlElement& element, Scene& scene);

/// Adds the bodies of operators to a scene whose other bodies are known: one named `operator`, or several by
/// their names; then tethers of all bodies. Throw YamlError.
void read_operator(const YamlElement& element, Scene& scene);
void read_operators(const YamlElement& element, Scene& scene);
void read_tethers(const YamlElement& element, Scene& scene);

}  // namespace mrhi
