#include "record.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>
#include <iterator>
#include <stdexcept>

#include "../math/fnv1a.h"
#include "../text/files.h"
#include "../text/text.h"
#include "../text/yaml.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

const std::string kUrdf = "scene.urdf", kYaml = "scene.yaml";
constexpr std::size_t kMaxFileBytes = 64u << 20;  // of a scene's files
constexpr std::size_t kMaxYamlBytes = 4u << 20;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("recorded change: " + what + "; allowed: what this package has recorded");
}

YAML::Node recorded_yaml(const std::string& yaml) {
  return rethrown<std::invalid_argument, YamlError>(
      "", [&] { return load_yaml("recorded change", yaml, kMaxYamlBytes); });
}

std::string text_in(const YAML::Node& node, const char* key) {
  const YAML::Node value = node.IsMap() ? node[key] : YAML::Node(YAML::NodeType::Undefined);
  if (!value || !value.IsScalar()) refuse(std::string("no '") + key + "'");
  return value.Scalar();
}

/// File name of a spawned URDF. A whole URDF may have no name: a hash of its text names it.
std::string spawned_file(const ObjectRequest& request) {
  const std::string& urdf = request.urdf;
  const std::string name =
      request.name.empty() ? std::to_string(Fnv1a().add(urdf.data(), urdf.size()).value) : request.name;
  return "spawn/" + name + ".urdf";
}

YAML::Node pose_node(const Pose& pose) {
  const Vector3& p = pose.position;
  const Quaternion& q = pose.orientation;
  return yaml_list({p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()});
}

YAML::Node twist_node(const Twist& twist) {
  const Vector3 &v = twist.linear, &w = twist.angular;
  return yaml_list({v.x(), v.y(), v.z(), w.x(), w.y(), w.z()});
}

YAML::Node request_node(const ObjectRequest& request) {
  YAML::Node node;
  node["name"] = request.name;
  if (!request.urdf.empty()) node["urdf"] = spawned_file(request);
  if (request.urdf.empty()) {
    node["shape"] = request.shape;
    node["size"] = yaml_list(request.size);
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
    node["rgba"] = yaml_list({double(c[0]), double(c[1]), double(c[2]), double(c[3])});
  }
  return node;
}

std::vector<double> numbers_in(const YAML::Node& node, std::size_t count) {
  if (!node || !node.IsSequence() || (count > 0 && node.size() != count) || node.size() > 100)
    refuse("not " + std::to_string(count) + " numbers");
  std::vector<double> values;
  for (const YAML::Node& item : node) {
    const std::string text = item.IsScalar() ? item.Scalar() : "";
    const auto value = text::to_number(text);
    if (!value) refuse("'" + text::one_line(text, 40) + "' is no number");
    values.push_back(*value);
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
    const RecordedFile* file = text::find_named(files, text_in(node, "urdf"));
    if (file == nullptr) refuse("the URDF of '" + text::one_line(request.name, 60) + "' is missing");
    request.urdf = file->bytes();
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

/// Returns what `read` does. Reports YAML of the wrong form, such as a text instead of a map.
template <class Read>
auto in_known_form(const Read& read) {
  try {
    return read();
  } catch (const YAML::Exception&) {
    refuse("a part has another form than it needs");
  }
}

struct Applier {
  LiveSimulation& simulation;

  void operator()(const Spawn& spawn) const { simulation.add(spawn.prepared->part); }
  void operator()(const Delete& remove) const { simulation.remove(remove.name); }
  void operator()(const SetParameters& set) const { simulation.set_parameters(set.values); }
  void operator()(const PlaceObject& place) const { simulation.place(place.name, place.pose); }
  void operator()(const Restrain& restrain) const { simulation.restrain(restrain.on); }
  void operator()(const Reset&) const { simulation.reset(); }
  void operator()(const Pause&) const {}
};

struct TextWriter {
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

struct YamlWriter {
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

/// A recorded name as a relative path, which leads to no folder above.
fs::path path_below(const std::string& name) {
  fs::path path;
  for (const fs::path& part : fs::path(name).relative_path()) path /= part == ".." ? fs::path("up") : part;
  return path;
}

void add_files(const RecordedFiles& files, World& world) {
  for (const RecordedFile& file : files) {
    if (RecordedFile* const known = text::find_named(world.files, file.name)) {
      *known = file;
    } else {
      world.files.push_back(file);
    }
  }
}

std::vector<std::string> roots_of(const Scene& part) {
  std::vector<std::string> roots;
  for (std::size_t body = 0; body < part.bodies.size(); ++body)
    if (hanging_on(body, part).size() == part.bodies.size()) roots.push_back(part.bodies[body].name);
  return roots;
}

}  // namespace

RecordedFiles contents_of(const std::vector<SceneFile>& files) {
  RecordedFiles contents;
  for (const SceneFile& file : files) {
    const auto bytes = file_text(file.path, kMaxFileBytes + 1);
    if (bytes && bytes->size() <= kMaxFileBytes) contents.push_back({file.name, *bytes});
  }
  return contents;
}

/// Keeps the names of the files below one folder, so that a mesh finds the files that it names. Files of
/// earlier changes stay: another content goes to another folder.
std::map<std::string, std::string> written_to(const std::string& folder, const RecordedFiles& files) {
  fs::path base;
  const auto path_of = [&](const RecordedFile& file) { return base / path_below(file.name); };
  const auto is_other = [&](const RecordedFile& file) {
    return fs::exists(path_of(file)) &&
           file_text(path_of(file).string(), file.bytes().size() + 1) != file.bytes();
  };
  int i = 0;
  do {
    base = fs::path(folder) / std::to_string(i++);
  } while (std::any_of(files.begin(), files.end(), is_other));
  fs::create_directories(folder);
  std::map<std::string, std::string> paths;
  for (const RecordedFile& file : files) {
    fs::create_directories(path_of(file).parent_path());
    write_file(path_of(file).string(), file.bytes());
    paths[file.name] = path_of(file).string();
  }
  return paths;
}

PreparedSpawn::PreparedSpawn(const ObjectRequest& request, const SceneOptions& options)
    : part(requested_scene(request, options)), geometry(part), files(contents_of(part.mesh_files)) {}

void prepare(Change& change, const SceneOptions& options) {
  if (auto* spawn = std::get_if<Spawn>(&change))
    spawn->prepared = std::make_shared<const PreparedSpawn>(spawn->request, options);
}

void apply_change(const Change& change, LiveSimulation& simulation) {
  std::visit(Applier{simulation}, change);
}

std::vector<Event> events_ended_by(const Change& change, const LiveSimulation& simulation) {
  if (const auto* remove = std::get_if<Delete>(&change)) return simulation.events_if_removed(remove->name);
  if (std::holds_alternative<Reset>(change)) return simulation.events_if_reset();
  return {};
}

std::string to_text(const Change& change) {
  return std::visit(TextWriter{}, change);
}

std::string to_yaml(const Change& change) {
  YamlWriter writer;
  std::visit(writer, change);
  return YAML::Dump(writer.node);
}

RecordedFiles files_of(const Change& change) {
  const Spawn* spawn = std::get_if<Spawn>(&change);
  if (spawn == nullptr || spawn->request.urdf.empty()) return {};
  RecordedFiles files = spawn->prepared->files;
  files.push_back({spawned_file(spawn->request), spawn->request.urdf});
  return files;
}

Change change_from_yaml(const std::string& yaml, const RecordedFiles& files) {
  const YAML::Node node = recorded_yaml(yaml);
  if (!node.IsMap()) refuse("is no map");
  return in_known_form([&]() -> Change {
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

World world_of_file(const std::string& urdf_file, const Scene& scene, const Configuration& configuration) {
  World world;
  world.version = MR_HAND_INTERACTION_VERSION;
  world.scene = fs::path(urdf_file).stem().string();
  const std::string yaml = fs::path(urdf_file).replace_extension(".yaml").string();
  world.files = contents_of({{kUrdf, urdf_file}, {kYaml, yaml}});
  add_files(contents_of(scene.mesh_files), world);
  world.parameters = parameter_texts(configuration);
  return world;
}

void note(const Change& change, const LiveSimulation& simulation, World& world) {
  const Configuration& configuration = simulation.simulation().configuration();
  if (const auto* spawn = std::get_if<Spawn>(&change)) {
    world.added.push_back({spawn->request, roots_of(spawn->prepared->part)});
    add_files(files_of(change), world);
  } else if (const auto* remove = std::get_if<Delete>(&change)) {
    const auto added = std::find_if(world.added.begin(), world.added.end(), [&](const Added& one) {
      return std::find(one.roots.begin(), one.roots.end(), remove->name) != one.roots.end();
    });
    if (added == world.added.end()) {
      world.removed.push_back(remove->name);
    } else {
      world.added.erase(added);
    }
    const Scene& scene = simulation.simulation().scene();
    for (auto mode = world.grasps.begin(); mode != world.grasps.end();)
      mode = find_body(scene, mode->first) ? std::next(mode) : world.grasps.erase(mode);
  } else if (const auto* set = std::get_if<SetParameters>(&change)) {
    world.parameters = parameter_texts(configuration);
    for (const auto& [name, value] : set->values)
      if (const auto object = grasp_parameter(name)) world.grasps[*object] = value;
  }
}

std::string to_yaml(const World& world) {
  YAML::Node node;
  node["version"] = world.version;
  node["scene"] = world.scene;
  for (const auto& [name, twist] : world.twists) node["object_twist"][name] = twist_node(twist);
  for (const auto& [name, value] : world.parameters) node["parameters"][name] = value;
  for (const auto& [name, mode] : world.grasps) node["grasp"][name] = mode;
  for (const std::string& name : world.removed) node["removed"].push_back(name);
  for (const Added& added : world.added) node["added"].push_back(request_node(added.request));
  return YAML::Dump(node);
}

World world_from_yaml(const std::string& yaml, const RecordedFiles& files) {
  const YAML::Node node = recorded_yaml(yaml);
  return in_known_form([&] {
    World world;
    world.version = text_in(node, "version");
    world.scene = fs::path(text_in(node, "scene")).filename().string();
    world.files = files;
    for (const auto& entry : node["object_twist"])
      world.twists[entry.first.Scalar()] = twist_in(entry.second);
    for (const auto& entry : node["parameters"]) {
      if (!entry.second.IsScalar())
        throw std::invalid_argument("recorded parameters: no text; allowed: YAML in text");
      world.parameters[entry.first.Scalar()] = entry.second.Scalar();
    }
    for (const auto& entry : node["grasp"]) world.grasps[entry.first.Scalar()] = entry.second.Scalar();
    for (const YAML::Node& name : node["removed"]) world.removed.push_back(name.Scalar());
    for (const YAML::Node& request : node["added"]) world.added.push_back({request_in(request, files)});
    return world;
  });
}

Configuration configuration_of(const World& world, std::vector<std::string>& unknown) {
  Configuration configuration;
  for (const auto& [name, value] : world.parameters) {
    try {
      set_parameter(configuration, name, value);
    } catch (const ParameterError& error) {
      unknown.emplace_back(error.what());
    }
  }
  validate(configuration);
  return configuration;
}

Scene scene_of(const World& world, SceneOptions options, const std::string& folder) {
  options.gravity.reset();
  options.mesh_files = written_to(folder, world.files);
  const auto urdf = options.mesh_files.find(kUrdf);
  if (urdf == options.mesh_files.end())
    throw SceneError("the recording has no scene.urdf; allowed: one that has");
  Scene scene = load_scene(urdf->second, options);
  scene.name = world.scene;
  for (const auto& [name, twist] : world.twists) free_body(scene, name).start_twist = twist;
  const auto remove = [&scene](const std::string& name) {
    const std::optional<int> body = find_body(scene, name);
    if (body) remove_body(*body, scene);
    return body.has_value();
  };
  std::vector<std::string> of_requests;  // removed bodies that requests had added
  for (const std::string& name : world.removed)
    if (!remove(name)) of_requests.push_back(name);
  for (const Added& added : world.added) append(requested_scene(added.request, options), scene);
  for (const std::string& name : of_requests) remove(name);
  for (const auto& [name, mode] : world.grasps) {
    if (const std::optional<int> body = find_body(scene, name))
      scene.bodies[*body].grasp = grasp_mode(mode).value_or(GraspMode::parameter);
  }
  return scene;
}

}  // namespace mrhi
