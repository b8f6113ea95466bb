#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "support/temporary_folder.h"
#include "synthetic/motions.h"
#include "synthetic/person.h"
#include "training/operator_trial.h"

namespace mrhi::testing {

inline Body shipped_body(const std::string& name) {
  Scene scene = load_scene(find_scene_file(name, {"config/scenes"}), {});
  return free_body(scene, name);
}

/// Of one object, at the places of the shipped task.
inline Task task_with(const std::string& object) {
  Task task = load_task("config/tasks/pick_and_place.yaml");
  std::vector<TaskObject> objects;
  for (const TaskObject& candidate : task.objects) {
    if (candidate.name == object) objects.push_back(candidate);
  }
  task.objects = objects;
  return task;
}

inline SessionHeader simulated_header() {
  SessionHeader header;
  header.participant = "P01";
  header.group = "beginner";
  header.handedness = "right";
  header.condition = "implicit";
  header.simulated = true;
  return header;
}

/// The row of a session's one trial.
inline TrialRow play(const Task& task, const OperatorSkill& skill, std::uint64_t seed, double noise) {
  const test::Folder folder;
  Session session(task, simulated_header(), 0, folder.path(), 0);
  OperatorStage stage;
  stage.scene_folders = {"config/scenes"};
  stage.scene_options.default_material = default_material(stage.configuration);
  stage.noise = noise;
  play_trial(session, skill, seed, stage, 0);
  return *session.last();
}

}  // namespace mrhi::testing
