#pragma once

#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// The numbers a setting may take: two finite ends always; max is one of them.
struct Range {
  constexpr Range(double least, double most, bool least_allowed = true)
      : min(least), max(most), min_allowed(least_allowed) {}

  double min, max;
  bool min_allowed;

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
