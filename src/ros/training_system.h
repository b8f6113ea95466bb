#pragma once

#include <mr_hand_interaction/DeleteObject.h>
#include <mr_hand_interaction/SetParameter.h>
#include <mr_hand_interaction/SpawnObject.h>
#include <mr_hand_interaction/SpawnUrdf.h>
#include <ros/ros.h>
#include <std_srvs/SetBool.h>
#include <std_srvs/Trigger.h>

#include <chrono>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "../record/record.h"
#include "../text/text.h"
#include "../training/operator_trial.h"
#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "mr_hand_interaction/ros/server_parameters.h"
#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/training/session.h"
#include "node.h"
#include "result_messages.h"

namespace mrhi {
/// Parameters of the training node on the parameter server.
struct TrainingParameters {
  /// Throws ParameterError with the first that is unknown, missing or invalid.
  explicit TrainingParameters(const ros::NodeHandle& private_node) {
    constexpr double kMaxBreak = 3600.0;  // [s]
    NodeParameters known;
    known.text("task", task);
    known.required("participant", "who takes part, such as P07", header.participant);
    known.text("group", header.group)
        .text("handedness", header.handedness)
        .text("condition", header.condition);
    known.whole("seed", 0, header.seed).whole("session", 1, header.session).whole("number", 1, number);
    known.truth("simulated", header.simulated).truth("operator", by_operator).truth("auto_start", auto_start);
    known.required("folder", "where the session is to be", folder).text("simulation", simulation);
    known.number("auto_next", -kMaxBreak, kMaxBreak, auto_next, " [s], below 0: not by itself");
    known.read(private_node);
    const char* const home = std::getenv("HOME");
    if (home != nullptr && folder.compare(0, 2, "~/") == 0) folder = home + folder.substr(1);
  }

  /// Configuration of the interaction node, from the parameter server, with a task's gravity.
  Configuration expected_configuration(const ros::NodeHandle& node, const Vector3& gravity) const {
    Configuration configuration = configuration_of(node);
    configuration.gravity = gravity;
    return configuration;
  }

  /// Throws SceneError, SessionError, or std::invalid_argument for a task that operators cannot perform.
  Session open_session(const ros::NodeHandle& node, Nanoseconds now,
                       const std::function<void(const EventRow&)>& on_event) const {
    const std::string file = find_task_file(task, task_folders());
    const Task loaded = load_task(file);
    OperatorStage stage;
    stage.scene_folders = scene_folders();
    if (by_operator) check_operator(loaded, stage);
    const Configuration configuration = configuration_of(node);
    const SessionSetup setup = session_setup(file, loaded, configuration, scene_folders(),
                                             scene_options(configuration), MR_HAND_INTERACTION_VERSION);
    SessionHeader started = header;
    started.started = utc_now(false);
    started.software = MR_HAND_INTERACTION_VERSION;
    const std::uint64_t place =
        number ? static_cast<std::uint64_t>(*number - 1) : participant_place(header.participant);
    return Session(loaded, started, place, folder, now, setup, {[] { return utc_now(true); }, on_event});
  }

  std::string task = "pick_and_place";  ///< ~task: name or YAML file
  SessionHeader header;       ///< ~participant, ~group, ~handedness, ~condition, ~seed, ~session, ~simulated
  std::optional<int> number;  ///< ~number: of the participant, from 1; default: the end of the name
  std::string folder;         ///< ~folder: of the session; a leading ~ is the home directory
  std::string simulation = "interaction_node";  ///< ~simulation: name of the node with the objects
  double auto_next = 3.0;    ///< ~auto_next: break after a trial [s]; below 0: wait for ~next
  bool auto_start = false;   ///< ~auto_start: start the first trial without ~next
  bool by_operator = false;  ///< ~operator: a simulated operator performs the task, which is checked

 private:
  /// With or without milliseconds.
  static std::string utc_now(bool with_milliseconds) {
    const auto since = std::chrono::system_clock::now().time_since_epoch();
    const auto ms = std::chrono::duration_cast<std::chrono::milliseconds>(since).count();
    const std::time_t seconds = static_cast<std::time_t>(ms / 1000);
    char whole[32];
    std::strftime(whole, sizeof whole, "%Y-%m-%dT%H:%M:%S", std::gmtime(&seconds));
    return whole + (with_milliseconds ? text::format(".%03d", static_cast<int>(ms % 1000)) : "") + "Z";
  }

  Configuration configuration_of(const ros::NodeHandle& node) const {
    return read_server_parameters(ros::NodeHandle(node, simulation)).configuration;
  }
};

/// Sets up a task's objects in the scene of a running interaction_node, by its services.
class TrainingScene {
 public:
  /// Throws SceneError for an object whose file cannot be read.
  TrainingScene(const std::string& simulation, const Task& task) : task_(task), simulation_(simulation) {
    needs_operator_ = !load_surroundings(task, scene_folders(), scene_options({})).operators.empty();
    for (const TaskObject& object : task.objects)
      models_[object.name] = load_object(object, task.goals, scene_folders(), scene_options({}));
    for (const Fixture& fixture : task.fixtures)
      models_[fixture.name] = load_fixture(fixture, scene_folders(), scene_options({}));
  }

  /// Records the moving bodies of the scene, from its messages.
  void note_objects(std::set<std::string> names, bool has_operator) {
    names_ = std::move(names);
    has_operator_ = has_operator;
  }

  /// Sets the task's gravity and fixtures, and removes all free bodies and devices but this one, which is
  /// reset to its start. Resets an operator too. Returns an error, or an empty string.
  std::string prepare(const TaskObject& object) {
    if (!names_) return "the simulation has not published its objects yet";
    if (needs_operator_ && !has_operator_)
      return "the simulation has no operator; allowed: its scene is that of the task (" + task_.scene + ")";
    for (const TaskObject& other : task_.objects) {
      if (models_.at(other.name).is_device()) remove(other.name);
    }
    for (const std::string& name : *names_) remove(name);
    std_srvs::Trigger reset;
    std::string wrong = set_up_ ? "" : set_up();
    if (wrong.empty() && needs_operator_) wrong = call("reset", reset);
    return wrong.empty() ? spawn(models_.at(object.name)) : wrong;
  }

  std::string pause(bool paused) {
    std_srvs::SetBool service;
    service.request.data = paused;
    return call("pause", service);
  }

  const ObjectModel& model(const std::string& object) const { return models_.at(object); }

 private:
  template <class Service>
  std::string call(const std::string& name, Service& service) const {
    const std::string resolved = ros::names::resolve(simulation_ + "/" + name);
    if (!ros::service::call(resolved, service)) return "service " + resolved + " does not answer";
    return service.response.success ? "" : service.response.message;
  }

  std::string set_up() {
    mr_hand_interaction::SetParameter gravity;
    gravity.request.name = "gravity";
    gravity.request.value = text::vector(task_.gravity);
    if (const std::string wrong = call("set", gravity); !wrong.empty()) return wrong;
    for (const Fixture& fixture : task_.fixtures) {
      remove(fixture.name);  // of an earlier session
      const std::string wrong = spawn(models_.at(fixture.name));
      if (!wrong.empty()) return wrong;
    }
    set_up_ = true;
    return "";
  }

  std::string spawn(const ObjectModel& model) {
    const ObjectRequest& request = model.request;
    if (model.is_device()) {
      mr_hand_interaction::SpawnUrdf service;
      service.request.urdf = request.urdf;
      service.request.joints = request.joints;
      service.request.pose = to_message(request.pose);
      return call("spawn_urdf", service);
    }
    mr_hand_interaction::SpawnObject service;
    service.request.name = request.name;
    service.request.urdf = request.urdf;
    service.request.pose = to_message(request.pose);
    service.request.twist = to_message(request.twist);
    service.request.material = request.material;
    return call("spawn", service);
  }

  std::string remove(const std::string& name) {
    mr_hand_interaction::DeleteObject service;
    service.request.name = name;
    return call("delete", service);
  }

  const Task& task_;
  const std::string simulation_;                // the node's name
  std::map<std::string, ObjectModel> models_;   // of objects and fixtures
  std::optional<std::set<std::string>> names_;  // empty before the first message
  bool set_up_ = false, has_operator_ = false, needs_operator_ = false;
};

/// Finds changes of the parameters of a running interaction_node in its `simulation_input`.
class ParameterWatch {
 public:
  struct Difference {
    std::string name, value;  ///< present value
    bool as_begun;            ///< true if it is as expected again
  };

  /// `configuration`: expected values. Ignores the gravity of a BEGIN, which the session sets later.
  explicit ParameterWatch(const Configuration& configuration)
      : begun_(parameter_texts(configuration)), now_(configuration) {}

  /// Returns the differences that this message causes.
  std::vector<Difference> take(const mr_hand_interaction::SimulationInput& message) {
    const bool may_set = message.kind == message.BEGIN ||
                         (message.kind == message.CHANGE && message.text.find("set") != std::string::npos);
    if (!may_set) return {};
    const LogEntry entry = from_message(message);
    Configuration later = now_;
    if (entry.kind == LogEntry::Kind::begin) {
      std::vector<std::string> unknown;
      later = configuration_of(world_from_yaml(entry.text, entry.files), unknown);
      later.gravity = now_.gravity;
    } else {
      const Change change = change_from_yaml(entry.text, entry.files);
      const auto* const set = std::get_if<SetParameters>(&change);
      if (set == nullptr) return {};
      for (const auto& [name, value] : set->values)
        if (!grasp_parameter(name)) set_parameter(later, name, value);
    }
    std::vector<Difference> differences;
    const auto before = parameter_texts(now_);
    for (const auto& [name, value] : parameter_texts(later)) {
      if (value != before.at(name)) differences.push_back({name, value, value == begun_.at(name)});
    }
    now_ = later;
    return differences;
  }

 private:
  const std::map<std::string, std::string> begun_;
  Configuration now_;
};

}  // namespace mrhi
