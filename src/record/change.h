#pragma once

#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "mr_hand_interaction/live_simulation.h"
#include "mr_hand_interaction/scene/object_request.h"

namespace mrhi {

/// A file by content. `name`: scene.urdf or scene.yaml, spawn/NAME.urdf, or as a URDF names its mesh.
struct RecordedFile {
  std::string name, bytes;
};
using RecordedFiles = std::vector<RecordedFile>;

/// The files that a URDF names as filename="...", as far as they can be read; relative paths start at
/// `folder`.
RecordedFiles mesh_files(const std::string& xml, const std::string& folder);

/// Writes those of `files` that a URDF names into `folder`, and returns the URDF with their paths there.
std::string with_meshes_in(const std::string& folder, std::string xml, const RecordedFiles& files);

// What a running simulation may be asked for besides hands.
struct Spawn {
  ObjectRequest request;  ///< with its name
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
struct Reset {};
/// Stops the clock; the simulation itself is not told.
struct Pause {
  bool on = true;
};
using Change = std::variant<Spawn, Delete, SetParameters, PlaceObject, Reset, Pause>;

/// The one way by which the node and a replay make a change. Throws as LiveSimulation does, or SceneError;
/// then nothing has changed.
void make(const Change& change, LiveSimulation& simulation);

/// In words, for people: "spawn 'box'".
std::string to_text(const Change& change);

/// As YAML in which numbers keep their bits. URDFs stand in files_of().
std::string to_yaml(const Change& change);
/// The URDF that a change brings, and the meshes that it names as far as they can be read.
RecordedFiles files_of(const Change& change);
/// Throws std::invalid_argument with one line.
Change change_from_yaml(const std::string& yaml, const RecordedFiles& files);

}  // namespace mrhi
