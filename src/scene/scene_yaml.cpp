#include "scene_yaml.h"

#include <algorithm>
#include <set>

#include "material_fields.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "text.h"
#include "yaml_values.h"

namespace mrhi {
namespace {

/// A node and its path in the file ("materials/cube"), for messages.
struct Element {
  const std::string& file;
  std::string path;
  YAML::Node node;

  Element at(const std::string& key) const {
    return {file, path.empty() ? key : path + "/" + key, node[key]};
  }
  [[noreturn]] void fail(const std::string& what) const {
    throw SceneError(yaml_place(file, node.Mark()) + ": " + path + (path.empty() ? "" : ": ") + what);
  }
  [[noreturn]] void refuse(const std::string& allowed) const {
    fail(yaml_text(node) + " is not allowed; allowed: " + allowed);
  }
};

/// The keys of a map, each known and given once.
std::vector<std::string> checked_keys(const Element& map, const std::vector<std::string>& known) {
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

Vector3 read_vector(const Element& element) {
  const std::optional<Vector3> vector = yaml_vector(element.node);
  if (!vector) element.refuse("three finite numbers [x, y, z]");
  return *vector;
}

void read_bounds(const Element& element, Bounds& bounds) {
  for (const std::string& key : checked_keys(element, {"min", "max"})) {
    (key == "min" ? bounds.min : bounds.max) = read_vector(element.at(key));
  }
  if ((bounds.min.array() < bounds.max.array()).all()) return;
  element.fail("min " + text::vector(bounds.min) + " is not below max " + text::vector(bounds.max) +
               "; allowed: min below max on each axis");
}

void read_material(const Element& element, Material& material) {
  std::vector<std::string> known;
  for (const MaterialField& field : material_fields()) known.push_back(field.name);
  const std::vector<std::string> keys = checked_keys(element, known);
  for (const MaterialField& field : material_fields()) {
    if (std::find(keys.begin(), keys.end(), field.name) == keys.end()) continue;
    const Element given = element.at(field.name);
    const std::optional<double> value = yaml_number(given.node);
    if (!value || !field.range.contains(*value)) given.refuse(field.range.describe() + field.unit);
    material.*field.value = *value;
  }
  if (const auto conflict = material_conflict(material)) element.fail(*conflict);
}

void read_materials(const Element& element, Scene& scene) {
  std::vector<std::string> links;
  for (const Body& body : scene.bodies) links.push_back(body.name);
  for (const std::string& link : checked_keys(element, links)) {
    read_material(element.at(link), scene.bodies[*find_body(scene, link)].material);
  }
}

}  // namespace

void apply_scene_yaml(const std::string& yaml_file, Scene& scene) {
  try {
    const Element root{yaml_file, "", YAML::LoadFile(yaml_file)};
    if (root.node.IsNull()) return;
    for (const std::string& key : checked_keys(root, {"gravity", "bounds", "materials"})) {
      const Element element = root.at(key);
      if (key == "gravity") scene.gravity = read_vector(element);
      if (key == "bounds") read_bounds(element, scene.bounds);
      if (key == "materials") read_materials(element, scene);
    }
  } catch (const YAML::Exception& error) {
    throw SceneError(yaml_place(yaml_file, error.mark) + ": not YAML: " + text::one_line(error.msg));
  }
}

}  // namespace mrhi
