#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "../collision/scene_geometry.h"
#include "mr_hand_interaction/live_simulation.h"
#include "mr_hand_interaction/scene/object_request.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {
/// A file by content. `name`: scene.urdf or scene.yaml, spawn/NAME.urdf, or as a URDF names its mesh.
struct RecordedFile {
  std::string name, bytes;
};
using RecordedFiles = std::vector<RecordedFile>;

/// The mesh files that a scene was made of, and nothing else that a URDF may name.
RecordedFiles contents_of(const std::vector<SceneFile>& files);

/// Writes `files` into `folder`, for SceneOptions::mesh_files. Others that are there stay.
std::map<std::string, std::string> written_to(const std::string& folder, const RecordedFiles& files);

/// The bodies that a spawn adds, with their meshes ready for collision, and the files that they were read
/// from.
struct PreparedSpawn {
  PreparedSpawn(const ObjectRequest& request, const SceneOptions& options);
  PreparedSpawn(const PreparedSpawn&) = delete;
  PreparedSpawn& operator=(const PreparedSpawn&) = delete;

  Scene part;
  SceneGeometry geometry;  ///< of `part`: keeps its colliders until the simulation has them
  RecordedFiles files;
};

// Changes of a running simulation, other than hands.
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
/// Stops the clock; the simulation does not know.
struct Pause {
  bool on = true;
};
using Change = std::variant<Spawn, Delete, SetParameters, PlaceObject, Restrain, Reset, Pause>;

/// The one way by which the node and a replay make a change. Throws as LiveSimulation does, or SceneError;
/// then nothing has changed.
void make(const Change& change, LiveSimulation& simulation);

/// In words, for people: "spawn 'box'".
std::string to_text(const Change& change);

/// YAML in which numbers keep their bits. URDFs are in files_of().
std::string to_yaml(const Change& change);
/// The URDF that a change brings, and the meshes that were read for it.
RecordedFiles files_of(const Change& change);
/// Throws std::invalid_argument with one line.
Change change_from_yaml(const std::string& yaml, const RecordedFiles& files);

/// A spawn, and the bodies with each of which all of it goes.
struct Added {
  ObjectRequest request;
  std::vector<std::string> roots = {};
};

/// Initial scene and parameters of a simulation and all changes since: enough to build its scene again on
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

/// World of a scene's file: reads it, the YAML beside it and the meshes of `scene`, as which it was loaded.
World world_of_file(const std::string& urdf_file, const Scene& scene, const Configuration& configuration);
void set_parameters(const Configuration& configuration, World& world);

/// Follows a change that has been made.
void note(const Change& change, const LiveSimulation& simulation, World& world);

std::string to_yaml(const World& world);
/// Throws std::invalid_argument with one line.
World world_from_yaml(const std::string& yaml, const RecordedFiles& files);

/// The parameters of the world. Unknown ones are reported in `unknown` and left out.
Configuration configuration_of(const World& world, std::vector<std::string>& unknown);
/// Files are written to `folder` to be read. Throws SceneError.
Scene scene_of(const World& world, const Configuration& configuration, const std::string& folder);

/// One thing that a live simulation was given; SimulationInput.msg without ROS.
struct LogEntry {
  enum class Kind : std::uint8_t { begin, frame, without_hands, change };

  Kind kind = Kind::begin;
  std::uint64_t run = 0, sequence = 0;
  Nanoseconds stamp = 0;           ///< of the hands' stream
  Nanoseconds time = 0;            ///< without hands: up to when, of the simulation
  Nanoseconds expected = 0;        ///< of a frame: see Simulation::begin
  std::string text;                ///< of a begin: a World; of a change: a Change
  RecordedFiles files;             ///< that belong to the text
  std::string state;               ///< of a begin: to_bytes()
  std::optional<HandFrame> hands;  ///< of a frame, stamp of the simulation
  std::uint64_t state_hash = 0;    ///< after it
  std::uint64_t lost = 0;          ///< frames that have not reached the node, so far
};

/// The recorded inputs of a live simulation, in order.
class LogSource {
 public:
  virtual ~LogSource() = default;
  /// Nothing at the end. Throws std::exception with one line if it cannot be read any further.
  virtual std::optional<LogEntry> next() = 0;
  virtual std::size_t position() const = 0;
  virtual std::size_t size() const = 0;
};

}  // namespace mrhi
