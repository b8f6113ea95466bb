#include "scene_yaml.h"

#include <algorithm>

#include "../text/safe_yaml.h"
#include "../text/text.h"
#include "../text/yaml_values.h"
#include "limits.h"
#include "material_fields.h"
#include "mr_hand_interaction/scene/scene_loader.h"

namespace mrhi {
namespace {

using Element = YamlElement;

void read_bounds(const Element& element, Bounds& bounds) {
  for (const std::string& key : checked_keys(element, {"min", "max"})) {
    (key == "min" ? bounds.min : bounds.max) = read_vector(element.at(key));
  }
  if ((bounds.min.array() < bounds.max.array()).all()) return;
  element.fail("min " + text::vector(bounds.min) + " is not below max " + text::vector(bounds.max) +
               "; allowed: min below max on each axis");
}

void read_material(const Element& element, Body& body) {
  std::vector<std::string> known;
  for (const MaterialField& field : material_fields()) known.push_back(field.name);
  const std::vector<std::string> keys = checked_keys(element, known);
  for (const MaterialField& field : material_fields()) {
    if (std::find(keys.begin(), keys.end(), field.name) == keys.end()) continue;
    const Element given = element.at(field.name);
    const std::optional<double> value = yaml_number(given.node);
    if (!value || !field.range.contains(*value)) given.refuse(field.range.describe() + field.unit);
    body.material.*field.value = *value;
    body.own_material.*field.own = true;
  }
  if (const auto conflict = material_conflict(body.material)) element.fail(*conflict);
}

void read_materials(const Element& element, Scene& scene) {
  std::vector<std::string> links;
  for (const Body& body : scene.bodies) links.push_back(body.name);
  for (const std::string& link : checked_keys(element, links)) {
    read_material(element.at(link), scene.bodies[*find_body(scene, link)]);
  }
}

void read_grasps(const Element& element, Scene& scene) {
  for (const std::string& link : checked_keys(element, graspable_bodies(scene))) {
    const Element given = element.at(link);
    const auto mode = given.node.IsScalar() ? grasp_mode(given.node.Scalar()) : std::nullopt;
    if (!mode) given.refuse(kGraspModes);
    scene.bodies[static_cast<std::size_t>(*find_body(scene, link))].grasp = *mode;
  }
}

/// Of bodies at the start, as the service's: [vx, vy, vz, wx, wy, wz]. Joints take the part that they let
/// through.
void read_twists(const Element& element, Scene& scene) {
  std::vector<std::string> links;
  for (const Body& body : scene.bodies) {
    if (!body.fixed) links.push_back(body.name);
  }
  for (const std::string& link : checked_keys(element, links)) {
    const Element given = element.at(link);
    if (!given.node.IsSequence() || given.node.size() != 6) given.refuse("six numbers, m/s and rad/s");
    Vector3 parts[2];
    for (std::size_t i = 0; i < 6; ++i) {
      const double most = i < 3 ? body_limits::kSpeed.max : body_limits::kSpin.max;
      const std::optional<double> number = yaml_number(given.node[i]);
      if (!number || std::abs(*number) > most) given.at(i).refuse("numbers up to " + text::number(most));
      parts[i / 3][static_cast<Eigen::Index>(i % 3)] = *number;
    }
    scene.bodies[static_cast<std::size_t>(*find_body(scene, link))].start_twist = {parts[0], parts[1]};
  }
}

}  // namespace

void apply_scene_yaml(const std::string& yaml_file, Scene& scene) {
  read_yaml<SceneError>(yaml_file, [&] {
    const Element root{yaml_file, "", load_yaml_file(yaml_file)};
    if (root.node.IsNull()) return;
    const std::vector<std::string> keys = checked_keys(
        root,
        {"gravity", "bounds", "materials", "grasp", "twists", "joints", "operator", "operators", "tethers"});
    const auto has = [&](const char* key) { return std::find(keys.begin(), keys.end(), key) != keys.end(); };
    for (const std::string& key : keys) {
      const Element element = root.at(key);
      if (key == "gravity") scene.gravity = read_vector(element, body_limits::kGravity);
      if (key == "bounds") read_bounds(element, scene.bounds);
      if (key == "materials") read_materials(element, scene);
      if (key == "grasp") read_grasps(element, scene);
      if (key == "twists") read_twists(element, scene);
      if (key == "joints") read_joint_settings(element, scene);
    }
    if (has("operator") && has("operators"))
      root.fail("has both 'operator' and 'operators'; allowed: one of them");
    if (has("operator")) read_operator(root.at("operator"), scene);
    if (has("operators")) read_operators(root.at("operators"), scene);
    if (has("tethers")) read_tethers(root.at("tethers"), scene);
    if (!scene.operators.empty() && !scene.gravity.isZero(0.0))
      scene.warnings.push_back("the operator falls with gravity " + text::vector(scene.gravity) +
                               " m/s^2 as objects do; set gravity to 0 or use a restraint");
  });
}

void apply_joints_yaml(const std::string& source, const std::string& yaml, Scene& scene) {
  read_yaml<SceneError>(source, [&] { read_joint_settings({source, "", load_yaml(source, yaml)}, scene); });
}

void apply_material_yaml(const std::string& source, const std::string& yaml, Body& body) {
  read_yaml<SceneError>(source, [&] { read_material({source, "", load_yaml(source, yaml)}, body); });
}

}  // namespace mrhi
