#include "training_scene.h"

#include <mr_hand_interaction/DeleteObject.h>
#include <mr_hand_interaction/SetParameter.h>
#include <mr_hand_interaction/SpawnObject.h>
#include <mr_hand_interaction/SpawnUrdf.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

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

}  // namespace

TrainingScene::TrainingScene(ros::NodeHandle node, const std::string& simulation, const Task& task)
    : task_(task),
      spawn_(node.serviceClient<mr_hand_interaction::SpawnObject>(simulation + "/spawn")),
      spawn_urdf_(node.serviceClient<mr_hand_interaction::SpawnUrdf>(simulation + "/spawn_urdf")),
      delete_(node.serviceClient<mr_hand_interaction::DeleteObject>(simulation + "/delete")),
      set_(node.serviceClient<mr_hand_interaction::SetParameter>(simulation + "/set")),
      pause_(node.serviceClient<std_srvs::SetBool>(simulation + "/pause")),
      reset_(node.serviceClient<std_srvs::Trigger>(simulation + "/reset")) {
  needs_operator_ = !load_surroundings(task, scene_folders(), scene_options({})).operators.empty();
  for (const TaskObject& object : task.objects)
    models_[object.name] = load_object(object, task.goals, scene_folders(), scene_options({}));
  for (const Fixture& fixture : task.fixtures)
    models_[fixture.name] = load_fixture(fixture, scene_folders(), scene_options({}));
}

std::string TrainingScene::set_up() {
  mr_hand_interaction::SetParameter gravity;
  gravity.request.name = "gravity";
  gravity.request.value = text::vector(task_.gravity);
  if (const std::string wrong = call(set_, gravity); !wrong.empty()) return wrong;
  for (const Fixture& fixture : task_.fixtures) {
    remove(fixture.name);  // of a session before
    const std::string wrong = spawn(models_.at(fixture.name));
    if (!wrong.empty()) return wrong;
  }
  set_up_ = true;
  return "";
}

std::string TrainingScene::prepare(const TaskObject& object) {
  if (!names_) return "the simulation has not told yet what moves in its scene";
  if (needs_operator_ && !has_operator_)
    return "the simulation has no operator; allowed: its scene is that of the task (" + task_.scene + ")";
  for (const TaskObject& other : task_.objects) {
    if (models_.at(other.name).is_device()) remove(other.name);
  }
  for (const std::string& name : *names_) remove(name);
  if (!set_up_) {
    if (const std::string wrong = set_up(); !wrong.empty()) return wrong;
  }
  std_srvs::Trigger reset;
  if (needs_operator_) {
    if (const std::string wrong = call(reset_, reset); !wrong.empty()) return wrong;
  }
  return spawn(models_.at(object.name));
}

std::string TrainingScene::spawn(const ObjectModel& model) {
  const ObjectRequest& request = model.request;
  if (model.is_device()) {
    mr_hand_interaction::SpawnUrdf service;
    service.request.urdf = request.urdf;
    service.request.joints = request.joints;
    service.request.pose = to_message(request.pose);
    return call(spawn_urdf_, service);
  }
  mr_hand_interaction::SpawnObject service;
  service.request.name = request.name;
  service.request.urdf = request.urdf;
  service.request.pose = to_message(request.pose);
  service.request.twist.linear = vector_message(request.twist.linear);
  service.request.twist.angular = vector_message(request.twist.angular);
  service.request.material = request.material;
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
