#include "change.h"

#include <stdexcept>

#include "change_yaml.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "urdf_meshes.h"

namespace mrhi {
namespace {

struct Making {
  LiveSimulation& simulation;

  void operator()(const Spawn& spawn) const {
    simulation.add(requested_scene(spawn.request, scene_options(simulation.simulation().configuration())));
  }
  void operator()(const Delete& remove) const { simulation.remove(remove.name); }
  void operator()(const SetParameters& set) const { simulation.set_parameters(set.values); }
  void operator()(const PlaceObject& place) const { simulation.place(place.name, place.pose); }
  void operator()(const Reset&) const { simulation.reset(); }
  void operator()(const Pause&) const {}
};

struct InWords {
  std::string operator()(const Spawn& spawn) const { return "spawn '" + spawn.request.name + "'"; }
  std::string operator()(const Delete& remove) const { return "delete '" + remove.name + "'"; }
  std::string operator()(const SetParameters& set) const {
    std::string text = "set";
    for (const auto& [name, value] : set.values) text += " " + name + "=" + value;
    return text;
  }
  std::string operator()(const PlaceObject& place) const { return "place '" + place.name + "'"; }
  std::string operator()(const Reset&) const { return "reset"; }
  std::string operator()(const Pause& pause) const { return pause.on ? "pause" : "go on"; }
};

struct AsNode {
  YAML::Node node;

  void operator()(const Spawn& spawn) { node["spawn"] = request_node(spawn.request); }
  void operator()(const Delete& remove) { node["delete"] = remove.name; }
  void operator()(const SetParameters& set) {
    for (const auto& [name, value] : set.values) {
      YAML::Node pair(std::vector<std::string>{name, value});
      node["set"].push_back(pair);
    }
  }
  void operator()(const PlaceObject& place) {
    node["place"] = place.name;
    node["pose"] = pose_node(place.pose);
  }
  void operator()(const Reset&) { node["reset"] = "all"; }
  void operator()(const Pause& pause) { node["pause"] = pause.on ? "on" : "off"; }
};

SetParameters values_in(const YAML::Node& node) {
  SetParameters set;
  for (const YAML::Node& pair : node) {
    if (!pair.IsSequence() || pair.size() != 2 || !pair[0].IsScalar() || !pair[1].IsScalar())
      throw std::invalid_argument("recorded change: 'set' has no names and values; allowed: [[NAME, VALUE]]");
    set.values.emplace_back(pair[0].Scalar(), pair[1].Scalar());
  }
  return set;
}

}  // namespace

void make(const Change& change, LiveSimulation& simulation) {
  std::visit(Making{simulation}, change);
}

std::string to_text(const Change& change) {
  return std::visit(InWords{}, change);
}

std::string to_yaml(const Change& change) {
  AsNode as_node;
  std::visit(as_node, change);
  return YAML::Dump(as_node.node);
}

RecordedFiles files_of(const Change& change) {
  const Spawn* spawn = std::get_if<Spawn>(&change);
  if (spawn == nullptr || spawn->request.urdf.empty()) return {};
  RecordedFiles files = mesh_files(spawn->request.urdf, "");
  files.push_back({spawned_file(spawn->request), spawn->request.urdf});
  return files;
}

Change change_from_yaml(const std::string& yaml, const RecordedFiles& files) {
  const YAML::Node node = recorded_yaml(yaml);
  if (!node.IsMap()) throw std::invalid_argument("recorded change: is no map; allowed: one");
  if (node["spawn"]) return Spawn{request_in(node["spawn"], files)};
  if (node["delete"]) return Delete{text_in(node, "delete")};
  if (node["set"]) return values_in(node["set"]);
  if (node["place"]) return PlaceObject{text_in(node, "place"), pose_in(node["pose"])};
  if (node["reset"]) return Reset{};
  if (node["pause"]) return Pause{text_in(node, "pause") == "on"};
  throw std::invalid_argument(
      "recorded change: is not known; allowed: spawn, delete, set, place, reset, pause");
}

}  // namespace mrhi
