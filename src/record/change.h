#pragma once

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "../collision/scene_geometry.h"
#include "mr_hand_interaction/live_simulation.h"
#include "mr_hand_interaction/scene/object_request.h"

namespace mrhi {

/// A file by content. `name`: scene.urdf or scene.yaml, spawn/NAME.urdf, or as a URDF names its mesh.
struct RecordedFile {
  std::string name, bytes;
};
using RecordedFiles = std::vector<RecordedFile>;

/// The mesh files that a scene was made of, and nothing else that a URDF may name.
RecordedFiles contents_of(const std::vector<SceneFile>& files);

/// Writes `files` into `folder`, for SceneOptions::mesh_files.
std::map<std::string, std::string> written_to(const std::string& folder, const RecordedFiles& files);

/// What a spawn adds, with its meshes ready for collision, and the files that it was read from.
struct PreparedSpawn {
  PreparedSpawn(const ObjectRequest& request, const SceneOptions& options);
  PreparedSpawn(const PreparedSpawn&) = delete;
  PreparedSpawn& operator=(const PreparedSpawn&) = delete;

  Scene part;
  SceneGeometry geometry;  ///< of `part`: keeps its colliders until the simulation has them
  RecordedFiles files;
};

// What a running simulation may be asked for besides hands.
struct Spawn {
  ObjectRequest request;                               ///< with its name, and a URDF as text
  std::shared_ptr<const PreparedSpawn> prepared = {};  ///< of the request; null: prepared when it is made
};
struct Delete {
  std::string name;
};
struct SetParameters {
  std::vector<std::pair<std::string, std::string>> values;  ///< names of parameters.h, YAML
};
struct PlaceObject {
  std::string name;
  Pose pose;  ///< of the centre of mass, in world
};
/// Restraints of operators hold, or release.
struct Restrain {
  bool on = true;
};
struct Reset {};
/// Stops the clock; the simulation itself is not told.
struct Pause {
  bool on = true;
};
using Change = std::variant<Spawn, Delete, SetParameters, PlaceObject, Restrain, Reset, Pause>;

/// The one way by which the node and a replay make a change. Throws as LiveSimulation does, or SceneError;
/// then nothing has changed.
void make(const Change& change, LiveSimulation& simulation);

/// In words, for people: "spawn 'box'".
std::string to_text(const Change& change);

/// As YAML in which numbers keep their bits. URDFs stand in files_of().
std::string to_yaml(const Change& change);
/// The URDF that a change brings, and the meshes that were read for it.
RecordedFiles files_of(const Change& change);
/// Throws std::invalid_argument with one line.
Change change_from_yaml(const std::string& yaml, const RecordedFiles& files);

}  // namespace mrhi
