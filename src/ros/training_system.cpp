#include "training_system.h"

#include <mr_hand_interaction/DeleteObject.h>
#include <mr_hand_interaction/SetParameter.h>
#include <mr_hand_interaction/SpawnObject.h>
#include <mr_hand_interaction/SpawnUrdf.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "../record/record.h"
#include "../text/text.h"
#include "../training/operator_trial.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "mr_hand_interaction/ros/server_parameters.h"
#include "node.h"

namespace mrhi {
namespace {

template <class Service>
std::string call(ros::ServiceClient& client, Service& service) {
  if (!client.call(service)) return "service " + client.getService() + " does not answer";
  return service.response.success ? "" : service.response.message;
}

Task task_of(const TrainingParameters& parameters) {
  Task task = load_task(find_task_file(parameters.task, task_folders()));
  OperatorStage stage;
  stage.scene_folders = scene_folders();
  if (parameters.by_operator) check_operator(task, stage);
  return task;
}

/// With the milliseconds, or without.
std::string utc_now(bool with_milliseconds) {
  const auto since = std::chrono::system_clock::now().time_since_epoch();
  const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(since).count();
  const std::time_t seconds = static_cast<std::time_t>(ms / 1000);
  char whole[32], part[16] = "";
  std::strftime(whole, sizeof whole, "%Y-%m-%dT%H:%M:%S", std::gmtime(&seconds));
  if (with_milliseconds) std::snprintf(part, sizeof part, ".%03d", static_cast<int>(ms % 1000));
  return std::string(whole) + part + "Z";
}

SessionHeader header_of(const TrainingParameters& parameters) {
  SessionHeader header = parameters.header;
  header.started = utc_now(false);
  header.software = MR_HAND_INTERACTION_VERSION;
  return header;
}

Configuration configuration_of(const ros::NodeHandle& node, const TrainingParameters& parameters) {
  return read_server_parameters(ros::NodeHandle(node, parameters.simulation)).configuration;
}

SessionSetup setup_of(const ros::NodeHandle& node, const TrainingParameters& parameters) {
  const std::string file = find_task_file(parameters.task, task_folders());
  const Configuration configuration = configuration_of(node, parameters);
  return session_setup(file, load_task(file), configuration, scene_folders(), scene_options(configuration),
                       MR_HAND_INTERACTION_VERSION);
}

std::uint64_t place_of(const TrainingParameters& parameters) {
  if (parameters.number) return static_cast<std::uint64_t>(*parameters.number - 1);
  return participant_place(parameters.header.participant);
}

}  // namespace

TrainingParameters::TrainingParameters(const ros::NodeHandle& private_node) {
  constexpr double kLongestBreak = 3600.0;  // [s]
  NodeParameters known;
  known.text("task", task).text("participant", header.participant).text("group", header.group);
  known.text("handedness", header.handedness).text("condition", header.condition);
  known.whole("seed", 0, header.seed).whole("session", 1, header.session).whole("number", 1, number);
  known.truth("simulated", header.simulated).truth("operator", by_operator).truth("auto_start", auto_start);
  known.text("folder", folder).text("simulation", simulation);
  known.number("auto_next", -kLongestBreak, kLongestBreak, auto_next, " [s], below 0: not by itself");
  known.read(private_node);
  const char* const home = std::getenv("HOME");
  if (home != nullptr && folder.compare(0, 2, "~/") == 0) folder = home + folder.substr(1);
  const auto require = [](const char* name, const std::string& value, const std::string& allowed) {
    if (value.empty())
      throw ParameterError("parameter '" + std::string(name) + "': '' is not allowed; allowed: " + allowed);
  };
  require("participant", header.participant, "who takes part, such as P07");
  require("folder", folder, "where the session is to be");
}

Configuration told_configuration(const ros::NodeHandle& node, const TrainingParameters& parameters,
                                 const Vector3& gravity) {
  Configuration configuration = configuration_of(node, parameters);
  configuration.gravity = gravity;
  return configuration;
}

Session open_session(const ros::NodeHandle& node, const TrainingParameters& parameters, Nanoseconds now,
                     const std::function<void(const EventRow&)>& on_event) {
  return Session(task_of(parameters), header_of(parameters), place_of(parameters), parameters.folder, now,
                 setup_of(node, parameters), {[] { return utc_now(true); }, on_event});
}

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

namespace {

using mr_hand_interaction::SimulationInput;

std::map<std::string, std::string> texts_of(const Configuration& configuration) {
  std::map<std::string, std::string> texts;
  for (const std::string& name : parameter_names()) texts[name] = parameter_text(configuration, name);
  return texts;
}

RecordedFiles files_of(const SimulationInput& message) {
  RecordedFiles files;
  for (const auto& file : message.files) files.push_back({file.name, {file.bytes.begin(), file.bytes.end()}});
  return files;
}

/// As they are once the message has been taken.
Configuration after(const SimulationInput& message, Configuration configuration) {
  if (message.kind == SimulationInput::BEGIN) {
    const auto gravity = configuration.gravity;
    std::vector<std::string> unknown;
    configuration = configuration_of(world_from_yaml(message.text, files_of(message)), unknown);
    configuration.gravity = gravity;
    return configuration;
  }
  const Change change = change_from_yaml(message.text, files_of(message));
  if (const auto* set = std::get_if<SetParameters>(&change)) {
    for (const auto& [name, value] : set->values)
      if (!grasp_parameter(name)) set_parameter(configuration, name, value);
  }
  return configuration;
}

bool may_set(const SimulationInput& message) {
  if (message.kind == SimulationInput::BEGIN) return true;
  return message.kind == SimulationInput::CHANGE && message.text.find("set") != std::string::npos;
}

}  // namespace

ParameterWatch::ParameterWatch(const Configuration& configuration)
    : begun_(texts_of(configuration)), now_(configuration) {}

std::vector<ParameterWatch::Difference> ParameterWatch::take(const SimulationInput& message) {
  if (!may_set(message)) return {};
  const Configuration later = after(message, now_);
  std::vector<Difference> differences;
  const Texts before = texts_of(now_);
  for (const auto& [name, value] : texts_of(later)) {
    if (value != before.at(name)) differences.push_back({name, value, value == begun_.at(name)});
  }
  now_ = later;
  return differences;
}

}  // namespace mrhi
