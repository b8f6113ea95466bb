#pragma once

#include <mr_hand_interaction/ObjectState.h>
#include <mr_hand_interaction/SimulationInput.h>
#include <mr_hand_interaction/TrainingStatus.h>
#include <ros/ros.h>
#include <visualization_msgs/MarkerArray.h>

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "../training/operator_trial.h"
#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/training/session.h"

namespace mrhi {
/// What the training node is told on the parameter server.
struct TrainingParameters {
  /// Throws ParameterError naming a parameter that is unknown, missing or not allowed.
  explicit TrainingParameters(const ros::NodeHandle& private_node);

  std::string task = "pick_and_place";  ///< ~task: name or YAML file
  SessionHeader header;       ///< ~participant, ~group, ~handedness, ~condition, ~seed, ~session, ~simulated
  std::optional<int> number;  ///< ~number: of the participant, from 1; else the one that ends the name
  std::string folder;         ///< ~folder: of the session; a ~ at its beginning is the home directory
  std::string simulation = "interaction_node";  ///< ~simulation: name of the node with the objects
  double auto_next = 3.0;    ///< ~auto_next: break after a trial [s]; below 0: the next one waits for ~next
  bool auto_start = false;   ///< ~auto_start: the first trial does not wait for ~next
  bool by_operator = false;  ///< ~operator: a simulated operator does the task, which is checked
};

/// What the node with the objects was told on the parameter server, under a task's gravity.
Configuration told_configuration(const ros::NodeHandle& node, const TrainingParameters& parameters,
                                 const Vector3& gravity);
/// Throws SceneError for a task that cannot be loaded, std::invalid_argument for one that a simulated
/// operator cannot do, SessionError for a folder that cannot be used.
Session open_session(const ros::NodeHandle& node, const TrainingParameters& parameters, Nanoseconds now,
                     const std::function<void(const EventRow&)>& on_event);

/// Puts the objects of a task into the scene of a running interaction_node, by its services.
class TrainingScene {
 public:
  /// Throws SceneError for an object whose file cannot be read.
  TrainingScene(ros::NodeHandle node, const std::string& simulation, const Task& task);

  /// What moves in the scene; from its messages.
  void note_objects(std::set<std::string> names, bool has_operator) {
    names_ = std::move(names);
    has_operator_ = has_operator;
  }

  /// The task's gravity and fixtures, and of free bodies and devices this one alone, at its start. An
  /// operator is at the start too. Empty, or what went wrong.
  std::string prepare(const TaskObject& object);
  std::string pause(bool paused);

  const ObjectModel& model(const std::string& object) const { return models_.at(object); }

 private:
  std::string set_up();
  std::string spawn(const ObjectModel& model);
  std::string remove(const std::string& name);

  const Task& task_;
  std::map<std::string, ObjectModel> models_;   // of objects and fixtures
  std::optional<std::set<std::string>> names_;  // none before the first message
  bool set_up_ = false, has_operator_ = false, needs_operator_ = false;
  ros::ServiceClient spawn_, spawn_urdf_, delete_, set_, pause_, reset_;
};

/// Follows the parameters of a running interaction_node by its `simulation_input`, whatever changes them:
/// services, sliders, or another start.
class ParameterWatch {
 public:
  struct Difference {
    std::string name, value;  ///< the value that there is now
    bool as_begun;            ///< it is again what it was to be
  };

  /// What they are to be. Of a BEGIN gravity is passed over: a session sets it after it has begun to listen.
  explicit ParameterWatch(const Configuration& configuration);

  /// What this message has changed against all that came before.
  std::vector<Difference> take(const mr_hand_interaction::SimulationInput& message);

 private:
  using Texts = std::map<std::string, std::string>;
  const Texts begun_;
  Configuration now_;
};

/// What the participant is to do now, in a line.
std::string instruction_now(const Session& session, bool paused, bool begins_by_itself);

/// What rviz shows of a session, in the status's frame, a namespace for each layer: `target` (where the
/// object is to be; its ring fills with the time held), `places` (the others, fainter, with their numbers),
/// `path`, `object` (highlighted until it is held; `seen`: nothing if it is not there), `instructions`,
/// `timer` and `result`. They go if they are not shown again. What is to be read is nearer to the eye of
/// rviz/training.rviz than what hands do.
visualization_msgs::MarkerArray training_markers(const Session& session, const Body& body,
                                                 const mr_hand_interaction::TrainingStatus& status,
                                                 const std::optional<mr_hand_interaction::ObjectState>& seen);

}  // namespace mrhi
