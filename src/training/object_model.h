#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/scene/object_request.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/training/task.h"

namespace mrhi {

/// What a trial has of an object.
struct ObjectModel {
  ObjectRequest request;  ///< that puts it where it starts; `whole` for a device
  Scene scene;            ///< of it alone, there
  std::size_t body = 0;   ///< in it: of the object's name

  bool is_device() const { return request.whole; }
};

/// Throws SceneError for a file that cannot be read, that has other links than an object's, or lacks a joint
/// that the task's goals ask for.
ObjectModel load_object(const TaskObject& object, const std::vector<Goal>& goals,
                        const std::vector<std::string>& scene_folders, const SceneOptions& options);
/// The same for what is there in all trials, which is one body.
ObjectModel load_fixture(const Fixture& fixture, const std::vector<std::string>& scene_folders,
                         const SceneOptions& options);

/// The fixtures and operators of the task's scene, without its free bodies; empty if the task names no scene.
/// Throws SceneError for a file that cannot be read, or without the operator that a goal asks for.
Scene load_surroundings(const Task& task, const std::vector<std::string>& scene_folders,
                        const SceneOptions& options);

}  // namespace mrhi
