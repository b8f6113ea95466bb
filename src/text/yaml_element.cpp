#include "yaml_values.h"

#include <algorithm>
#include <set>

#include "mr_hand_interaction/scene/scene_loader.h"
#include "text.h"

namespace mrhi {

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
