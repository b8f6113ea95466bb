#pragma once

#include <ros/ros.h>

#include <map>
#include <set>
#include <string>

#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/training/task.h"

namespace mrhi {

/// Puts the objects of a task into the scene of a running interaction_node, by its services.
class TrainingScene {
 public:
  /// Throws SceneError for an object whose file cannot be read.
  TrainingScene(ros::NodeHandle node, const std::string& simulation, const Task& task);

  /// What moves in the scene; from its messages.
  void note_objects(std::set<std::string> names) { names_ = std::move(names); }

  /// The task's gravity and fixtures, and of free bodies this one alone, at its start. Empty, or what went
  /// wrong.
  std::string prepare(const TaskObject& object);
  std::string pause(bool paused);

  /// Of an object of the task, for its looks.
  const Body& body(const std::string& name) const { return bodies_.at(name).body; }

 private:
  struct Model {
    std::string xml, material;
    Body body;
  };

  static Model load(const std::string& name, const std::string& file);
  std::string set_up();
  std::string spawn(const std::string& name, const Model& model, const Pose& pose, const Twist& twist);
  std::string remove(const std::string& name);

  const Task& task_;
  std::map<std::string, Model> bodies_;
  std::set<std::string> names_;
  bool set_up_ = false;
  ros::ServiceClient spawn_, delete_, set_, pause_;
};

}  // namespace mrhi
