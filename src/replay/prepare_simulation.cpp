#include <functional>
#include <stdexcept>

#include "../collision/overlap.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/replay/replay.h"
#include "mr_hand_interaction/ros/package_paths.h"

namespace mrhi {
namespace {

Configuration configured(const ReplayArguments& arguments) {
  Configuration configuration;
  if (arguments.parameter_file) load_parameters(configuration, *arguments.parameter_file);
  try {
    for (const auto& [name, value] : arguments.settings) set_parameter(configuration, name, value);
    validate(configuration);
  } catch (const ParameterError& error) {
    throw UsageError(error.what());
  }
  return configuration;
}

Body& object_of(Scene& scene, const std::string& option, const std::string& name) {
  try {
    return free_body(scene, name);
  } catch (const std::invalid_argument& error) {
    throw UsageError(option + ": " + error.what());
  }
}

void place(Scene& scene, const std::string& name, const Pose& pose) {
  Body& body = object_of(scene, "--object-pose", name);
  const Bounds& bounds = scene.bounds;
  if ((pose.position.array() < bounds.min.array()).any() ||
      (pose.position.array() > bounds.max.array()).any()) {
    throw UsageError("--object-pose " + name + ": is out of the scene's bounds");
  }
  body.start = pose;
}

}  // namespace

Simulation prepare_simulation(const ReplayArguments& arguments) {
  const Configuration configuration = configured(arguments);
  std::string file;
  try {
    file = find_scene_file(arguments.scene, scene_folders());
  } catch (const SceneError& error) {
    throw UsageError(std::string("--scene: ") + error.what());
  }
  Scene scene = load_scene(file, scene_options(configuration));
  for (const auto& [name, pose] : arguments.object_poses) place(scene, name, pose);
  const std::string overlaps = arguments.object_poses.empty() ? "" : overlaps_at_start(scene);
  if (!overlaps.empty()) throw UsageError("--object-pose: " + overlaps + "; allowed: places that are free");
  for (const auto& [name, twist] : arguments.object_twists) {
    object_of(scene, "--object-twist", name).start_twist = twist;
  }
  return Simulation(std::move(scene), configuration);
}

}  // namespace mrhi
