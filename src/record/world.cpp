#include "world.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "../text/files.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "mr_hand_interaction/scene/scene.h"
#include "record_yaml.h"

namespace mrhi {
namespace {

namespace fs = std::filesystem;

const std::string kUrdf = "scene.urdf", kYaml = "scene.yaml";

std::string text_of(const fs::path& file) {
  constexpr std::size_t kMostBytes = std::size_t{64} << 20;
  return file_text(file.string(), kMostBytes).value_or("");
}

void write(const fs::path& file, const std::string& text) {
  std::ofstream out = file_to_write(file.string());
  out << text << std::flush;
  if (!out) throw std::runtime_error("cannot write " + file.string());
}

void add_files(const RecordedFiles& files, World& world) {
  for (const RecordedFile& file : files) {
    const auto known = std::find_if(world.files.begin(), world.files.end(),
                                    [&](const RecordedFile& other) { return other.name == file.name; });
    if (known == world.files.end()) {
      world.files.push_back(file);
    } else {
      *known = file;
    }
  }
}

std::vector<std::string> roots_of(const Scene& part) {
  std::vector<std::string> roots;
  for (std::size_t body = 0; body < part.bodies.size(); ++body)
    if (hanging_on(body, part).size() == part.bodies.size()) roots.push_back(part.bodies[body].name);
  return roots;
}

struct Following {
  const LiveSimulation& simulation;
  World& world;

  void operator()(const Spawn& spawn) const {
    const SceneOptions options = scene_options(simulation.simulation().configuration());
    const auto prepared =
        spawn.prepared ? spawn.prepared : std::make_shared<const PreparedSpawn>(spawn.request, options);
    world.added.push_back({spawn.request, roots_of(prepared->part)});
    add_files(files_of(Spawn{spawn.request, prepared}), world);
  }
  void operator()(const Delete& remove) const {
    const auto added = std::find_if(world.added.begin(), world.added.end(), [&](const Added& one) {
      return std::find(one.roots.begin(), one.roots.end(), remove.name) != one.roots.end();
    });
    if (added == world.added.end()) {
      world.removed.push_back(remove.name);
    } else {
      world.added.erase(added);
    }
    const Scene& scene = simulation.simulation().scene();
    for (auto mode = world.grasps.begin(); mode != world.grasps.end();)
      mode = find_body(scene, mode->first) ? std::next(mode) : world.grasps.erase(mode);
  }
  void operator()(const SetParameters& set) const {
    set_parameters(simulation.simulation().configuration(), world);
    for (const auto& [name, value] : set.values)
      if (const auto object = grasp_parameter(name)) world.grasps[*object] = value;
  }
  void operator()(const PlaceObject&) const {}
  void operator()(const Restrain&) const {}
  void operator()(const Reset&) const {}
  void operator()(const Pause&) const {}
};

Scene scene_of_files(const World& world, const SceneOptions& options, const std::string& folder) {
  const RecordedFile* urdf = find_file(world.files, kUrdf);
  if (urdf == nullptr) throw SceneError("the recording has no scene.urdf; allowed: one that has");
  const fs::path file = fs::path(folder) / (world.scene + ".urdf");
  write(file, urdf->bytes);
  if (const RecordedFile* yaml = find_file(world.files, kYaml))
    write(fs::path(folder) / (world.scene + ".yaml"), yaml->bytes);
  return load_scene(file.string(), options);
}

}  // namespace

World world_of_file(const std::string& urdf_file, const Scene& scene, const Configuration& configuration) {
  World world;
  world.version = MR_HAND_INTERACTION_VERSION;
  world.scene = fs::path(urdf_file).stem().string();
  world.files.push_back({kUrdf, text_of(urdf_file)});
  const fs::path yaml = fs::path(urdf_file).replace_extension(".yaml");
  if (fs::exists(yaml)) world.files.push_back({kYaml, text_of(yaml)});
  add_files(contents_of(scene.mesh_files), world);
  set_parameters(configuration, world);
  return world;
}

void set_parameters(const Configuration& configuration, World& world) {
  for (const std::string& name : parameter_names())
    world.parameters[name] = parameter_text(configuration, name);
}

void note(const Change& change, const LiveSimulation& simulation, World& world) {
  std::visit(Following{simulation, world}, change);
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
  return in_form([&] {
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

Scene scene_of(const World& world, const Configuration& configuration, const std::string& folder) {
  SceneOptions options = scene_options(configuration);
  options.gravity.reset();
  options.mesh_files = written_to(folder, world.files);
  Scene scene = scene_of_files(world, options, folder);
  for (const auto& [name, twist] : world.twists) free_body(scene, name).start_twist = twist;
  // What is not in the scene came with others, and has gone again.
  std::vector<std::string> gone_since;
  for (const std::string& name : world.removed) {
    if (const std::optional<int> body = find_body(scene, name)) {
      remove_body(static_cast<std::size_t>(*body), scene);
    } else {
      gone_since.push_back(name);
    }
  }
  for (const Added& added : world.added) append(requested_scene(added.request, options), scene);
  for (const std::string& name : gone_since) {
    if (const std::optional<int> body = find_body(scene, name))
      remove_body(static_cast<std::size_t>(*body), scene);
  }
  for (const auto& [name, mode] : world.grasps) {
    if (const std::optional<int> body = find_body(scene, name))
      scene.bodies[static_cast<std::size_t>(*body)].grasp = grasp_mode(mode).value_or(GraspMode::parameter);
  }
  return scene;
}

}  // namespace mrhi
