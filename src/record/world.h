#pragma once

#include <map>
#include <string>
#include <vector>

#include "change.h"

namespace mrhi {

/// A spawn, and the bodies with each of which all of it goes.
struct Added {
  ObjectRequest request;
  std::vector<std::string> roots = {};
};

/// What a simulation began with and what has been changed of it since: enough to build its scene anew on
/// another machine.
struct World {
  std::string version;                            ///< of the package that ran
  std::string scene;                              ///< its name
  RecordedFiles files;                            ///< scene.urdf, scene.yaml, meshes, spawned URDFs
  std::map<std::string, Twist> twists;            ///< at the start, by object
  std::map<std::string, std::string> parameters;  ///< all that there are, as YAML
  std::map<std::string, std::string> grasps;      ///< modes that were set while it ran, by object
  std::vector<std::string> removed;               ///< objects of the scene that are gone
  std::vector<Added> added;                       ///< what has come and is there, in its order
};

/// Of a scene's file: reads it, the YAML beside it and the meshes that `scene`, which it was loaded as, has.
World world_of_file(const std::string& urdf_file, const Scene& scene, const Configuration& configuration);
void set_parameters(const Configuration& configuration, World& world);

/// Follows a change that has been made.
void note(const Change& change, const LiveSimulation& simulation, World& world);

std::string to_yaml(const World& world);
/// Throws std::invalid_argument with one line.
World world_from_yaml(const std::string& yaml, const RecordedFiles& files);

/// The parameters of the world; those that are not known here are told in `unknown`, and left out.
Configuration configuration_of(const World& world, std::vector<std::string>& unknown);
/// Files are written to `folder` to be read. Throws SceneError.
Scene scene_of(const World& world, const Configuration& configuration, const std::string& folder);

}  // namespace mrhi
