#pragma once

#include <string>
#include <vector>

#include "../text/yaml_values.h"
#include "mr_hand_interaction/training/task.h"

/// Values of a task's file; each throws SceneError for what is not allowed.
namespace mrhi::task_yaml {

constexpr Range kAboveZero{0.0, 1e6, false}, kFromZero{0.0, 1e6};

double number(const YamlElement& element, const Range& range, const char* unit);
std::string string(const YamlElement& element);
std::string choice(const YamlElement& element, const std::string& one, const std::string& other);
/// See is_name().
std::string name(const YamlElement& element);
Vector3 unit_vector(const YamlElement& element);
Quaternion quaternion(const YamlElement& element);
Twist twist(const YamlElement& element);
void check_has(const YamlElement& element, const std::vector<std::string>& needed);

/// One entry of a task's `goals`. Throws SceneError.
Goal read_goal(const YamlElement& element);
/// Stages in their order, release last and after something that is held. Throws SceneError.
void check_order(const YamlElement& element, const std::vector<Goal>& goals);

}  // namespace mrhi::task_yaml
