#pragma once

#include <map>
#include <string>
#include <vector>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/training/task.h"

namespace mrhi {

/// What a session is played with: files by their names, with their bytes. A session's folder keeps them below
/// setup/, so that a session that goes on goes on with the same. Empty: nothing is kept.
struct SessionSetup {
  std::map<std::string, std::string> files;
};

/// The git revision that this library was built from, with a hash of what was changed since; "unknown" where
/// it was built outside of a repository.
std::string source_revision();

/// task.yaml (the file as it stands), parameters.yaml (every parameter's value; gravity is the task's), the
/// URDF and YAML of each object and fixture, meshes.txt (SHA-256 of the mesh files, if there are any),
/// software.yaml (version and revision) and SHA256SUMS of them all, which `sha256sum -c` reads. Throws
/// SceneError for a file that cannot be read.
SessionSetup session_setup(const std::string& task_file, const Task& task, Configuration configuration,
                           const std::vector<std::string>& scene_folders, const SceneOptions& options,
                           const std::string& version);

/// Writes them to FOLDER/setup, whole or not at all. Throws SessionError.
void write_setup(const std::string& folder, const SessionSetup& setup);

/// Throws SessionError that says where what is in FOLDER/setup differs first, if it does.
void check_same_setup(const std::string& folder, const SessionSetup& setup);

}  // namespace mrhi
