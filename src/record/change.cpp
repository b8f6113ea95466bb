#include "change.h"

#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "../text/files.h"
#include "../text/text.h"
#include "../text/yaml.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "record_yaml.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxMeshBytes = 64u << 20;  // of a mesh

constexpr std::size_t kMaxYamlBytes = 4u << 20;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("recorded change: " + what + "; allowed: what this package has recorded");
}

struct Making {
  LiveSimulation& simulation;

  void operator()(const Spawn& spawn) const {
    simulation.add(spawn.prepared ? spawn.prepared->part
                                  : requested_scene(spawn.request,
                                                    scene_options(simulation.simulation().configuration())));
  }
  void operator()(const Delete& remove) const { simulation.remove(remove.name); }
  void operator()(const SetParameters& set) const { simulation.set_parameters(set.values); }
  void operator()(const PlaceObject& place) const { simulation.place(place.name, place.pose); }
  void operator()(const Restrain& restrain) const { simulation.restrain(restrain.on); }
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
  std::string operator()(const Restrain& restrain) const { return restrain.on ? "restrain" : "release"; }
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
  void operator()(const Restrain& restrain) { node["restrain"] = restrain.on ? "on" : "off"; }
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

RecordedFiles contents_of(const std::vector<SceneFile>& files) {
  RecordedFiles contents;
  for (const SceneFile& file : files) {
    const auto bytes = file_text(file.path, kMaxMeshBytes + 1);
    if (bytes && bytes->size() <= kMaxMeshBytes) contents.push_back({file.name, *bytes});
  }
  return contents;
}

std::map<std::string, std::string> written_to(const std::string& folder, const RecordedFiles& files) {
  std::map<std::string, std::string> paths;
  for (const RecordedFile& file : files) {
    const fs::path path = fs::path(folder) /
                          ("mesh_" + std::to_string(paths.size()) + fs::path(file.name).extension().string());
    std::ofstream out = file_to_write(path.string());
    out << file.bytes << std::flush;
    if (!out) throw std::runtime_error("cannot write " + path.string());
    paths[file.name] = path.string();
  }
  return paths;
}

YAML::Node recorded_yaml(const std::string& yaml) {
  try {
    return load_yaml("recorded change", yaml, kMaxYamlBytes);
  } catch (const YamlError& error) {
    throw std::invalid_argument(error.what());
  }
}

std::string text_in(const YAML::Node& node, const char* key) {
  const YAML::Node value = node.IsMap() ? node[key] : YAML::Node(YAML::NodeType::Undefined);
  if (!value || !value.IsScalar()) refuse(std::string("no '") + key + "'");
  return value.Scalar();
}

void refuse_form() {
  refuse("a part has another form than it needs");
}

const RecordedFile* find_file(const RecordedFiles& files, const std::string& name) {
  for (const RecordedFile& file : files)
    if (file.name == name) return &file;
  return nullptr;
}

/// What is spawned whole may have no name: its text names it (FNV-1a).
std::string spawned_file(const ObjectRequest& request) {
  std::string name = request.name;
  if (name.empty()) {
    std::uint64_t sum = 0xcbf29ce484222325u;
    for (const char c : request.urdf) sum = (sum ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    name = std::to_string(sum);
  }
  return "spawn/" + name + ".urdf";
}

YAML::Node numbers_node(const std::vector<double>& values) {
  YAML::Node node(YAML::NodeType::Sequence);
  for (const double value : values) node.push_back(text::exact(value));
  node.SetStyle(YAML::EmitterStyle::Flow);
  return node;
}

YAML::Node pose_node(const Pose& pose) {
  const Vector3& p = pose.position;
  const Quaternion& q = pose.orientation;
  return numbers_node({p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
}

YAML::Node twist_node(const Twist& twist) {
  const Vector3 &v = twist.linear, &w = twist.angular;
  return numbers_node({v.x(), v.y(), v.z(), w.x(), w.y(), w.z()});
}

YAML::Node request_node(const ObjectRequest& request) {
  YAML::Node node;
  node["name"] = request.name;
  if (!request.urdf.empty()) node["urdf"] = spawned_file(request);
  if (request.urdf.empty()) {
    node["shape"] = request.shape;
    node["size"] = numbers_node(request.size);
    node["mass"] = text::exact(request.mass);
  }
  if (request.whole) {
    node["whole"] = "yes";
    node["joints"] = request.joints;
  }
  node["pose"] = pose_node(request.pose);
  node["twist"] = twist_node(request.twist);
  if (!request.material.empty()) node["material"] = request.material;
  if (request.rgba) {
    const auto& c = *request.rgba;
    node["rgba"] = numbers_node({double(c[0]), double(c[1]), double(c[2]), double(c[3])});
  }
  return node;
}

std::vector<double> numbers_in(const YAML::Node& node, std::size_t count) {
  if (!node || !node.IsSequence() || (count > 0 && node.size() != count) || node.size() > 100)
    refuse("not " + std::to_string(count) + " numbers");
  std::vector<double> values;
  for (const YAML::Node& item : node) {
    const std::string text = item.IsScalar() ? item.Scalar() : "";
    char* end = nullptr;
    values.push_back(std::strtod(text.c_str(), &end));
    if (text.empty() || *end != '\0') refuse("'" + text::one_line(text, 40) + "' is no number");
  }
  return values;
}

Pose pose_in(const YAML::Node& node) {
  const std::vector<double> v = numbers_in(node, 7);
  return {{v[0], v[1], v[2]}, Quaternion(v[6], v[3], v[4], v[5])};
}

Twist twist_in(const YAML::Node& node) {
  const std::vector<double> v = numbers_in(node, 6);
  return {{v[0], v[1], v[2]}, {v[3], v[4], v[5]}};
}

ObjectRequest request_in(const YAML::Node& node, const RecordedFiles& files) {
  ObjectRequest request;
  request.name = text_in(node, "name");
  if (node["urdf"]) {
    const RecordedFile* file = find_file(files, text_in(node, "urdf"));
    if (file == nullptr) refuse("the URDF of '" + text::one_line(request.name, 60) + "' is missing");
    request.urdf = file->bytes;
  } else {
    request.shape = text_in(node, "shape");
    request.size = numbers_in(node["size"], 0);
    request.mass = numbers_in(YAML::Node(std::vector<std::string>{text_in(node, "mass")}), 1)[0];
  }
  if (node["whole"]) {
    request.whole = true;
    request.joints = text_in(node, "joints");
  }
  request.pose = pose_in(node["pose"]);
  request.twist = twist_in(node["twist"]);
  if (node["material"]) request.material = text_in(node, "material");
  if (node["rgba"]) {
    const std::vector<double> c = numbers_in(node["rgba"], 4);
    request.rgba = {{float(c[0]), float(c[1]), float(c[2]), float(c[3])}};
  }
  return request;
}

PreparedSpawn::PreparedSpawn(const ObjectRequest& request, const SceneOptions& options)
    : part(requested_scene(request, options)), geometry(part), files(contents_of(part.mesh_files)) {}

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
  RecordedFiles files = spawn->prepared
                            ? spawn->prepared->files
                            : contents_of(requested_scene(spawn->request, scene_options({})).mesh_files);
  files.push_back({spawned_file(spawn->request), spawn->request.urdf});
  return files;
}

Change change_from_yaml(const std::string& yaml, const RecordedFiles& files) {
  const YAML::Node node = recorded_yaml(yaml);
  if (!node.IsMap()) refuse("is no map");
  return in_form([&]() -> Change {
    if (node["spawn"]) return Spawn{request_in(node["spawn"], files)};
    if (node["delete"]) return Delete{text_in(node, "delete")};
    if (node["set"]) return values_in(node["set"]);
    if (node["place"]) return PlaceObject{text_in(node, "place"), pose_in(node["pose"])};
    if (node["restrain"]) return Restrain{text_in(node, "restrain") == "on"};
    if (node["reset"]) return Reset{};
    if (node["pause"]) return Pause{text_in(node, "pause") == "on"};
    throw std::invalid_argument(
        "recorded change: is not known; allowed: spawn, delete, set, place, restrain, reset, pause");
  });
}

}  // namespace mrhi
