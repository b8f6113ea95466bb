#include "mr_hand_interaction/ros/training_scene.h"

#include <mr_hand_interaction/DeleteObject.h>
#include <mr_hand_interaction/SetParameter.h>
#include <mr_hand_interaction/SpawnObject.h>
#include <std_srvs/SetBool.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "../text/safe_yaml.h"
#include "../text/text.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/package_paths.h"

namespace mrhi {
namespace {

template <class Service>
std::string call(ros::ServiceClient& client, Service& service) {
  if (!client.call(service)) return "service " + client.getService() + " does not answer";
  return service.response.success ? "" : service.response.message;
}

std::string read_all(const std::string& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// The link's entry among the materials of the scene's YAML, as YAML; empty: none. The scene has been loaded.
std::string material_of(const std::string& link, const std::string& urdf_file) {
  const auto yaml_file = std::filesystem::path(urdf_file).replace_extension(".yaml");
  if (!std::filesystem::exists(yaml_file)) return "";
  const YAML::Node scene = load_yaml_file(yaml_file.string());
  if (!scene["materials"] || !scene["materials"][link]) return "";
  return text::one_line(YAML::Dump(scene["materials"][link]));
}

const Body& only_body(const std::string& name, const std::string& file, const Scene& scene) {
  if (scene.bodies.size() == 1 && scene.bodies.front().name == name) return scene.bodies.front();
  throw SceneError(file + ": is not of one link '" + name + "' with a shape; allowed in a task: that alone");
}

}  // namespace

TrainingScene::TrainingScene(ros::NodeHandle node, const std::string& simulation, const Task& task)
    : task_(task),
      spawn_(node.serviceClient<mr_hand_interaction::SpawnObject>(simulation + "/spawn")),
      delete_(node.serviceClient<mr_hand_interaction::DeleteObject>(simulation + "/delete")),
      set_(node.serviceClient<mr_hand_interaction::SetParameter>(simulation + "/set")),
      pause_(node.serviceClient<std_srvs::SetBool>(simulation + "/pause")) {
  for (const TaskObject& object : task.objects) bodies_[object.name] = load(object.name, object.file);
  for (const Fixture& fixture : task.fixtures) bodies_[fixture.name] = load(fixture.name, fixture.file);
}

TrainingScene::Model TrainingScene::load(const std::string& name, const std::string& file) {
  const std::string urdf = find_scene_file(file, scene_folders());
  const Scene scene = load_scene(urdf, scene_options({}));
  return {read_all(urdf), material_of(name, urdf), only_body(name, urdf, scene)};
}

std::string TrainingScene::set_up() {
  mr_hand_interaction::SetParameter gravity;
  gravity.request.name = "gravity";
  gravity.request.value = text::vector(task_.gravity);
  if (const std::string wrong = call(set_, gravity); !wrong.empty()) return wrong;
  for (const Fixture& fixture : task_.fixtures) {
    remove(fixture.name);  // of a session before
    const std::string wrong = spawn(fixture.name, bodies_.at(fixture.name), fixture.pose, {});
    if (!wrong.empty()) return wrong;
  }
  set_up_ = true;
  return "";
}

std::string TrainingScene::prepare(const TaskObject& object) {
  for (const std::string& name : names_) remove(name);
  if (!set_up_) {
    if (const std::string wrong = set_up(); !wrong.empty()) return wrong;
  }
  return spawn(object.name, bodies_.at(object.name), object.start, object.twist);
}

std::string TrainingScene::spawn(const std::string& name, const Model& model, const Pose& pose,
                                 const Twist& twist) {
  mr_hand_interaction::SpawnObject service;
  service.request.name = name;
  service.request.urdf = model.xml;
  service.request.pose = to_message(pose * model.body.link_in_body);
  service.request.twist.linear = vector_message(twist.linear);
  service.request.twist.angular = vector_message(twist.angular);
  service.request.material = model.material;
  return call(spawn_, service);
}

std::string TrainingScene::remove(const std::string& name) {
  mr_hand_interaction::DeleteObject service;
  service.request.name = name;
  return call(delete_, service);
}

std::string TrainingScene::pause(bool paused) {
  std_srvs::SetBool service;
  service.request.data = paused;
  return call(pause_, service);
}

}  // namespace mrhi
