#include "object_model.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <filesystem>

#include "../scene/scene_edit.h"
#include "../text/file_text.h"
#include "../text/safe_yaml.h"
#include "../text/text.h"
#include "../text/xml_danger.h"

namespace mrhi {
namespace {

/// What the YAML beside a URDF has under these keys, as YAML; empty: nothing. The scene has been loaded.
std::string beside(const std::string& urdf_file, const std::vector<std::string>& keys) {
  const auto file = std::filesystem::path(urdf_file).replace_extension(".yaml");
  if (!std::filesystem::exists(file)) return "";
  YAML::Node node = load_yaml_file(file.string());
  for (const std::string& key : keys) {
    if (!node[key]) return "";
    node.reset(node[key]);
  }
  return YAML::Dump(node);
}

std::string names_of(const std::vector<Joint>& joints) {
  std::vector<std::string> names;
  names.reserve(joints.size());
  for (const Joint& joint : joints) names.push_back(joint.name);
  return names.empty() ? "none, as it has no joints" : text::joined(names);
}

void check_goals(const TaskObject& object, const std::vector<Goal>& goals, const Scene& scene) {
  for (const Goal& goal : goals) {
    if (goal.kind == GoalKind::joint && !find_joint(scene, goal.joint))
      throw SceneError(object.file + ": a goal asks for joint '" + goal.joint +
                       "', which is not there; allowed: " + names_of(scene.joints));
  }
}

/// All links of a URDF, which hang on one.
void make_device(const TaskObject& object, const std::string& urdf, const SceneOptions& options,
                 ObjectModel& model) {
  if (object.twist.linear != Vector3::Zero() || object.twist.angular != Vector3::Zero())
    throw SceneError(object.file + ": '" + object.name +
                     "' is of links on joints, and has a twist; allowed: a twist of a lone body");
  model.request.whole = true;
  model.request.joints = beside(urdf, {"joints"});
  model.request.pose = object.start;
  model.scene = requested_scene(model.request, options);
  const std::optional<int> body = find_body(model.scene, object.name);
  if (!body || hanging_on(static_cast<std::size_t>(*body), model.scene).size() != model.scene.bodies.size())
    throw SceneError(object.file + ": not all hangs on a link '" + object.name +
                     "'; allowed: the name of that on which all others hang");
  model.body = static_cast<std::size_t>(*body);
}

void make_body(const TaskObject& object, const std::string& urdf, const Scene& scene, ObjectModel& model) {
  if (scene.bodies.size() != 1 || scene.bodies.front().name != object.name)
    throw SceneError(object.file + ": is not of one link '" + object.name +
                     "' with a shape, nor of links on joints; allowed in a task: these");
  model.scene = scene;
  Body& body = model.scene.bodies.front();
  body.start = object.start;
  body.start_twist = object.twist;
  model.request.name = object.name;
  model.request.material = text::one_line(beside(urdf, {"materials", object.name}));
  model.request.pose = object.start * body.link_in_body;
  model.request.twist = object.twist;
}

}  // namespace

ObjectModel load_object(const TaskObject& object, const std::vector<Goal>& goals,
                        const std::vector<std::string>& scene_folders, const SceneOptions& options) {
  const std::string urdf = find_scene_file(object.file, scene_folders);
  const Scene scene = load_scene(urdf, options);
  ObjectModel model;
  model.request.urdf = file_text(urdf, kMostXmlBytes).value_or("");
  if (scene.joints.empty()) {
    make_body(object, urdf, scene, model);
  } else {
    make_device(object, urdf, options, model);
  }
  check_goals(object, goals, model.scene);
  return model;
}

ObjectModel load_fixture(const Fixture& fixture, const std::vector<std::string>& scene_folders,
                         const SceneOptions& options) {
  ObjectModel model = load_object({fixture.name, fixture.file, fixture.pose, {}}, {}, scene_folders, options);
  if (model.is_device())
    throw SceneError(fixture.file + ": the fixture '" + fixture.name +
                     "' is of links on joints; allowed: one link with a shape");
  model.scene.bodies.front().fixed = true;
  return model;
}

Scene load_surroundings(const Task& task, const std::vector<std::string>& scene_folders,
                        const SceneOptions& options) {
  if (task.scene.empty()) return {};
  const std::string urdf = find_scene_file(task.scene, scene_folders);
  Scene scene = load_scene(urdf, options);
  for (std::size_t b = scene.bodies.size(); b-- > 0;) {
    if (b >= scene.bodies.size() || scene.bodies[b].fixed || scene.bodies[b].is_operator) continue;
    remove_body(b, scene);
  }
  const bool asked =
      std::any_of(task.goals.begin(), task.goals.end(), [](const Goal& goal) { return goal.of_operator; });
  if (asked && scene.operators.empty())
    throw SceneError(urdf + ": has no operator, whose rest a goal of task '" + task.name +
                     "' asks for; allowed: a scene with 'operator' in its YAML file");
  return scene;
}

}  // namespace mrhi
