#pragma once

#include <yaml-cpp/yaml.h>

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/parameters.h"

namespace mrhi {

/// One public parameter: all that setting, listing and refusing it needs.
struct ParameterEntry {
  std::string name;
  std::string allowed;  ///< what it may be, for messages
  /// False, and nothing changed, if the value is of a wrong type or out of range.
  std::function<bool(Configuration&, const YAML::Node&)> assign;
  /// What it is now, as YAML that `assign` takes.
  std::function<std::string(const Configuration&)> text;
  std::optional<ParameterLimits> limits;  ///< of a number, or of each of several
};

/// All parameters, sorted by name.
const std::vector<ParameterEntry>& parameter_table();

}  // namespace mrhi
