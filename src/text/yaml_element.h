#pragma once

#include <string>
#include <vector>

#include "yaml_values.h"

namespace mrhi {

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
