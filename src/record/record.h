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
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {
/// A file by content. `name`: scene.urdf or scene.yaml, spawn/NAME.urdf, or as a URDF names its mesh.
/// Copies share the bytes, which may be many.
class RecordedFile {
 public:
  RecordedFile(std::string file_name, std::string bytes)
      : name(std::move(file_name)), bytes_(std::make_shared<const std::string>(std::move(bytes))) {}
  const std::string& bytes() const { return *bytes_; }

  std::string name;

 private:
  std::shared_ptr<const std::string> bytes_;
};
using RecordedFiles = std::vector<RecordedFile>;

/// The mesh files that a scene uses, and no other file that a URDF may name.
RecordedFiles contents_of(const std::vector<SceneFile>& files);

/// Writes `files` into `folder`, for SceneOptions::mesh_files. Other files there stay.
std::map<std::string, std::string> written_to(const std::string& folder, const RecordedFiles& files);

/// The bodies that a spawn adds, prepared for collision, and the files of their meshes.
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
  std::shared_ptr<const PreparedSpawn> prepared = {};  ///< of the request; null until prepare()
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
/// Engages or releases the operators' restraints.
struct Restrain {
  bool on = true;
};
struct Reset {};
/// Stops the clock outside the simulation.
struct Pause {
  bool on = true;
};
using Change = std::variant<Spawn, Delete, SetParameters, PlaceObject, Restrain, Reset, Pause>;

/// Prepares a spawn before it is applied or recorded; other changes need nothing. Throws SceneError.
void prepare(Change& change, const SceneOptions& options);

/// Applies a change, or throws as LiveSimulation does; then nothing has changed.
void apply_change(const Change& change, LiveSimulation& simulation);
/// Events that deleting or resetting objects causes; report them before apply_change(). Throws likewise.
std::vector<Event> events_ended_by(const Change& change, const LiveSimulation& simulation);

/// Description for messages: "spawn 'box'".
std::string to_text(const Change& change);

/// The change as YAML, with exact numbers. URDFs are in files_of().
std::string to_yaml(const Change& change);
/// The URDF of a change, and the meshes that it uses.
RecordedFiles files_of(const Change& change);
/// Throws std::invalid_argument with one line.
Change change_from_yaml(const std::string& yaml, const RecordedFiles& files);

/// A spawn. Deleting any of the bodies `roots` deletes all of it.
struct Added {
  ObjectRequest request;
  std::vector<std::string> roots = {};
};

/// Initial scene and parameters of a simulation and all changes since; another machine can rebuild it.
struct World {
  std::string version;                            ///< of the package that ran it
  std::string scene;                              ///< its name
  RecordedFiles files;                            ///< scene.urdf, scene.yaml, meshes, spawned URDFs
  std::map<std::string, Twist> twists;            ///< at the start, by object
  std::map<std::string, std::string> parameters;  ///< all, as YAML
  std::map<std::string, std::string> grasps;      ///< modes set while it ran, by object
  std::vector<std::string> removed;               ///< objects of the scene that were removed
  std::vector<Added> added;                       ///< spawned objects that are present, in order
};

/// Creates the World of a scene's file: reads the file, its YAML, and the meshes of the loaded `scene`.
World world_of_file(const std::string& urdf_file, const Scene& scene, const Configuration& configuration);

/// Records a change that has been applied.
void note(const Change& change, const LiveSimulation& simulation, World& world);

std::string to_yaml(const World& world);
/// Throws std::invalid_argument with one line.
World world_from_yaml(const std::string& yaml, const RecordedFiles& files);

/// The parameters of the world. Unknown ones are added to `unknown` and left out.
Configuration configuration_of(const World& world, std::vector<std::string>& unknown);
/// Files are written to `folder` to be read. The scene keeps its own gravity. Throws SceneError.
Scene scene_of(const World& world, SceneOptions options, const std::string& folder);

/// One input of a live simulation: SimulationInput.msg without ROS.
struct LogEntry {
  enum class Kind : std::uint8_t { begin, frame, without_hands, change };

  Kind kind = Kind::begin;
  std::uint64_t run = 0, sequence = 0;
  Nanoseconds stamp = 0;           ///< in the stream of hands
  Nanoseconds time = 0;            ///< of silence: time of the simulation up to which it lasts
  Nanoseconds expected = 0;        ///< of a frame: see Simulation::begin
  std::string text;                ///< of a begin: a World; of a change: a Change
  RecordedFiles files;             ///< to which the text refers
  std::string state;               ///< of a begin: to_bytes()
  std::optional<HandFrame> hands;  ///< of a frame, stamp of the simulation
  std::uint64_t state_hash = 0;    ///< after this input
  std::uint64_t lost = 0;          ///< frames that have not reached the node, so far
};

/// What a recording holds, in the order in which it was recorded.
template <class Item>
class Source {
 public:
  virtual ~Source() = default;
  /// Returns the next item; empty at the end. Throws std::exception with one line if the rest cannot be read.
  virtual std::optional<Item> next() = 0;
  /// Number of messages read so far, and in all. The hands of a frame may be in separate messages.
  std::size_t position() const { return position_; }
  std::size_t size() const { return size_; }

 protected:
  std::size_t position_ = 0, size_ = 0;
};

/// The recorded inputs of a live simulation.
using LogSource = Source<LogEntry>;

}  // namespace mrhi
