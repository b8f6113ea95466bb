#include "scene_yaml.h"

namespace mrhi {
namespace {

double read_number(const YamlElement& element) {
  const std::optional<double> value = yaml_number(element.node);
  if (!value) element.refuse("a number");
  return *value;
}

JointSpring read_spring(const YamlElement& element) {
  JointSpring spring;
  for (const std::string& key : checked_keys(element, {"stiffness", "rest"}))
    (key == "stiffness" ? spring.stiffness : spring.rest) = read_number(element.at(key));
  return spring;
}

Detents read_detents(const YamlElement& element) {
  Detents detents;
  for (const std::string& key : checked_keys(element, {"at", "force"})) {
    const YamlElement given = element.at(key);
    if (key == "force") {
      detents.force = read_number(given);
      continue;
    }
    if (!given.node.IsSequence()) given.refuse("a list of places");
    for (std::size_t i = 0; i < given.node.size(); ++i) detents.at.push_back(read_number(given.at(i)));
  }
  return detents;
}

Latch read_latch(const YamlElement& element) {
  Latch latch;
  latch.reach = 0.005;
  for (const std::string& key : checked_keys(element, {"at", "force", "reach"}))
    (key == "at" ? latch.at : key == "force" ? latch.force : latch.reach) = read_number(element.at(key));
  return latch;
}

void read_joint(const YamlElement& element, Joint& joint) {
  for (const std::string& key :
       checked_keys(element, {"start", "damping", "friction", "restitution", "spring", "detents", "latch"})) {
    const YamlElement given = element.at(key);
    if (key == "start") joint.start = read_number(given);
    if (key == "damping") joint.damping = read_number(given);
    if (key == "friction") joint.friction = read_number(given);
    if (key == "restitution") joint.restitution = read_number(given);
    if (key == "spring") joint.spring = read_spring(given);
    if (key == "detents") joint.detents = read_detents(given);
    if (key == "latch") joint.latch = read_latch(given);
  }
}

}  // namespace

void read_joint_settings(const YamlElement& element, Scene& scene) {
  std::vector<std::string> names;
  for (const Joint& joint : scene.joints) names.push_back(joint.name);
  for (const std::string& name : checked_keys(element, names))
    read_joint(element.at(name), scene.joints[static_cast<std::size_t>(*find_joint(scene, name))]);
}

}  // namespace mrhi
