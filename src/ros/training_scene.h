#pragma once

#include <ros/ros.h>

#include <map>
#include <optional>
#include <set>
#include <string>

#include "../training/operator_trial.h"

namespace mrhi {

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

}  // namespace mrhi
