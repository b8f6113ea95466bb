#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "../synthetic/person.h"
#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/scene/object_request.h"
#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/training/session.h"
#include "mr_hand_interaction/training/task.h"

namespace mrhi {

/// An object as a trial uses it.
struct ObjectModel {
  ObjectRequest request;  ///< to spawn it at its start; `whole` for a device
  Scene scene;            ///< of this object alone, at its start
  std::size_t body = 0;   ///< index in `scene` of the body with the object's name

  bool is_device() const { return request.whole; }
};

/// Loads an object of a task. Throws SceneError for a file that cannot be read, has other links than the
/// object's, or lacks a joint that a goal needs.
ObjectModel load_object(const TaskObject& object, const std::vector<Goal>& goals,
                        const std::vector<std::string>& scene_folders, const SceneOptions& options);
/// Loads a fixture of a task, which is one body, likewise.
ObjectModel load_fixture(const Fixture& fixture, const std::vector<std::string>& scene_folders,
                         const SceneOptions& options);

/// The fixtures and operators of the task's scene, without its free bodies; empty if the task names no scene.
/// Throws SceneError for a file that cannot be read, or lacks the operator that a goal needs.
Scene load_surroundings(const Task& task, const std::vector<std::string>& scene_folders,
                        const SceneOptions& options);

/// Setup of simulated operators: the system, and its tracker.
struct OperatorStage {
  Configuration configuration;
  std::vector<std::string> scene_folders;
  SceneOptions scene_options;
  double frame_rate = 115.0;  ///< of the tracker [Hz]
  double noise = 1.0;         ///< amplitude of TrackingNoise
};

/// The scene of a trial with one object. With gravity the object stands on a table (a flat body on two rails,
/// so that a hand can grasp it from below). An object that falls off, or leaves the reach of the arm, returns
/// to its start. Throws SceneError.
Scene operator_scene(const Task& task, const TaskObject& object, const OperatorStage& stage);

/// Sight of an object and of the task's goals from `goal` on. The place of a goal `insert` is first outside
/// the hole on its axis, then inside.
Sight sight_of(const Task& task, std::size_t goal, const Pose& object, const Twist& twist, bool held);

/// Creates a SimulatedOperator, a PractisedPerson, or for a task with a goal `rest` a FloatingPerson that can
/// do the task with the object. `surroundings` has the task's operator and fixtures. Throws
/// std::invalid_argument that names the goal or the object, and what is allowed.
std::unique_ptr<Person> make_person(const OperatorSkill& skill, const Task& task, const Body& object,
                                    std::uint64_t seed, const Scene& surroundings = {});

/// Moves the person's hands to `time` [s], and returns them as a device at that pose sees them.
std::vector<HandJoints> hands_of(Person& person, double time, const Sight& sight, const Pose& device);

/// Throws as make_person() does for the first object with which a simulated operator cannot do the task.
void check_operator(const Task& task, const OperatorStage& stage);

/// A simulated operator does the session's next trial: it sees the object, and through the noisy tracker its
/// hand moves in a simulation. Stamps count on from `begin`; the result is the stamp of the last frame. No
/// clock is read: the same arguments give the same bits.
Nanoseconds play_trial(Session& session, const OperatorSkill& skill, std::uint64_t seed,
                       const OperatorStage& stage, Nanoseconds begin);

/// A table under the body, or where a hand takes it from below (a flat body) two rails under its ends.
Body stand_under(const Body& body);

}  // namespace mrhi
