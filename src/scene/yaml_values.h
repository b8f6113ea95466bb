#pragma once

#include <yaml-cpp/yaml.h>

#include <limits>
#include <optional>
#include <string>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// The numbers a setting may take; max is always one of them, infinity means no limit.
struct Range {
  double min;
  double max = std::numeric_limits<double>::infinity();
  bool min_allowed = true;

  bool contains(double value) const;
  std::string describe() const;  ///< "a number from 0 to 1"
};

/// Typed readers: nothing if the node is of another type or not finite.
std::optional<double> yaml_number(const YAML::Node& node);
std::optional<int> yaml_integer(const YAML::Node& node);
std::optional<Vector3> yaml_vector(const YAML::Node& node);

/// The node as one line of YAML, for messages.
std::string yaml_text(const YAML::Node& node);

/// "FILE:LINE" of a node.
std::string yaml_place(const std::string& file, const YAML::Mark& mark);

}  // namespace mrhi
