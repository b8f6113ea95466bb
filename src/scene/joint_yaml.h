#pragma once

#include "../text/yaml_element.h"
#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {

/// Sets of joints, by their names, what a URDF has no place for. What the numbers may be is
/// arrange_joints()'s to say. Throws YamlError.
void read_joint_settings(const YamlElement& element, Scene& scene);

}  // namespace mrhi
