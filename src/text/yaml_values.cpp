#include "yaml_values.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "mr_hand_interaction/scene/scene_loader.h"
#include "text.h"

namespace mrhi {

bool Range::contains(double value) const {
  return (min_allowed ? value >= min : value > min) && value <= max;  // not for NaN either
}

std::string Range::describe() const {
  const std::string low = text::number(min), high = text::number(max);
  return min_allowed ? "a number from " + low + " to " + high : "a number above " + low + ", at most " + high;
}

std::optional<double> yaml_number(const YAML::Node& node) {
  double value = 0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, value) || !std::isfinite(value)) return {};
  return value;
}

std::optional<int> yaml_integer(const YAML::Node& node) {
  int value = 0;
  if (!node.IsScalar() || !YAML::convert<int>::decode(node, value)) return {};
  return value;
}

std::optional<Vector3> yaml_vector(const YAML::Node& node) {
  if (!node.IsSequence() || node.size() != 3) return {};
  Vector3 vector;
  for (int i = 0; i < 3; ++i) {
    const std::optional<double> value = yaml_number(node[i]);
    if (!value) return {};
    vector[i] = *value;
  }
  return vector;
}

std::string yaml_text(const YAML::Node& node) {
  if (node.IsNull()) return "nothing";
  return text::one_line(node.IsScalar() ? node.Scalar() : YAML::Dump(node), 60);
}

std::string yaml_place(const std::string& file, const YAML::Mark& mark) {
  return mark.is_null() ? file : file + ":" + std::to_string(mark.line + 1);
}

YamlElement YamlElement::at(const std::string& key) const {
  return {file, path.empty() ? key : path + "/" + key, node[key]};
}

YamlElement YamlElement::at(std::size_t index) const {
  return {file, path + "/" + std::to_string(index + 1), node[index]};
}

void YamlElement::fail(const std::string& what) const {
  throw SceneError(yaml_place(file, node.Mark()) + ": " + path + (path.empty() ? "" : ": ") + what);
}

void YamlElement::refuse(const std::string& allowed) const {
  fail(yaml_text(node) + " is not allowed; allowed: " + allowed);
}

std::vector<std::string> checked_keys(const YamlElement& map, const std::vector<std::string>& known) {
  if (!map.node.IsMap()) map.refuse("a map with the keys " + text::joined(known));
  std::vector<std::string> keys;
  std::set<std::string> seen;
  for (const auto& entry : map.node) {
    const std::string key = yaml_text(entry.first);
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      map.fail("unknown key '" + key + "'; allowed: " + text::joined(known));
    }
    if (!seen.insert(key).second) map.fail("key '" + key + "' is given twice; allowed: once");
    keys.push_back(key);
  }
  return keys;
}

Vector3 read_vector(const YamlElement& element, const Range& range) {
  const std::optional<Vector3> vector = yaml_vector(element.node);
  if (!vector || !range.contains(vector->minCoeff()) || !range.contains(vector->maxCoeff()))
    element.refuse("three numbers [x, y, z] from " + text::number(range.min) + " to " +
                   text::number(range.max));
  return *vector;
}

}  // namespace mrhi
