#pragma once

#include <vector>

#include "../text/yaml_values.h"
#include "mr_hand_interaction/training/task.h"

namespace mrhi::task_yaml {

/// One entry of a task's `goals`. Throws SceneError.
Goal read_goal(const YamlElement& element);
/// Stages in their order, release last and after something that is held. Throws SceneError.
void check_order(const YamlElement& element, const std::vector<Goal>& goals);

}  // namespace mrhi::task_yaml
