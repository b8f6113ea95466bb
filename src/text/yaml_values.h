#pragma once

#include <yaml-cpp/yaml.h>
#include <optional>
#include <string>
#include <vector>

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

/// A node and its path in the file ("materials/cube"), for messages. What refuses throws SceneError.
struct YamlElement {
  const std::string& file;
  std::string path;
  YAML::Node node;

  YamlElement at(const std::string& key) const;
  YamlElement at(std::size_t index) const;  ///< of a sequence; its path counts from 1
  [[noreturn]] void fail(const std::string& what) const;
  [[noreturn]] void refuse(const std::string& allowed) const;
};

/// The keys of a map, each known and given once.
std::vector<std::string> checked_keys(const YamlElement& map, const std::vector<std::string>& known);

/// Three numbers, each in the range: places in m by default.
Vector3 read_vector(const YamlElement& element, const Range& range = {-1000, 1000});

}  // namespace mrhi
