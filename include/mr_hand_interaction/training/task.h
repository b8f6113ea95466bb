#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/joint.h"

namespace mrhi {

/// Stages of a trial. Numbers as in TrainingStatus.msg.
enum class TrainingStage : std::uint8_t { manipulation, maintenance, release };
constexpr int kTrainingStages = 3;
const char* to_string(TrainingStage stage);

enum class GoalKind : std::uint8_t {
  pick,        ///< held, and moved by `distance` from its place at the start of the trial
  place,       ///< held within the tolerances
  insert,      ///< the same, with an orientation
  catch_it,    ///< held for `hold`, and first held within `within` of the start of the trial
  nudge_into,  ///< not held, in the box and slower than max_speed
  strike,      ///< touched, and released at a speed of min_speed to max_speed (tap, slap)
  joint,       ///< a joint of the object is between `above` and `below`
  rest,        ///< the object or the operator's body is within the tolerances, no faster than max_speed and
               ///< max_spin
  release      ///< released; ends drift_time later
};
/// Name in a task's file; tap and slap are both "strike".
const char* to_string(GoalKind kind);

/// Effect on a timer when its condition ends.
enum class Leaving : std::uint8_t { reset, stop };

/// A goal of a task. Fields that its kind does not name above are not used.
struct Goal {
  GoalKind kind = GoalKind::pick;
  TrainingStage stage = TrainingStage::manipulation;
  std::string instruction;  ///< empty: generated from the other fields

  Vector3 position = Vector3::Zero();               ///< of the object's centre of mass, in world [m]
  Quaternion orientation = Quaternion::Identity();  ///< of the object's link
  double tolerance = 0.03;                          ///< [m]; `rest` without a position: infinite
  std::optional<double> angle_tolerance;            ///< [rad]; empty: any orientation
  std::optional<Vector3> axis;       ///< unit, of the object: the only aligned axis, in either direction
  Vector3 size = Vector3::Zero();    ///< of the box about `position` [m]
  double hold = 0.0;                 ///< required duration of the condition [s]
  Leaving leaving = Leaving::reset;  ///< effect on the time held so far
  double distance = 0.05;            ///< [m]
  std::optional<double> within;      ///< from the start of the trial; joint: from that of the goal [s]
  std::string joint;                 ///< name in the object's URDF
  double above = -Joint::kUnlimited, below = Joint::kUnlimited;  ///< [rad]; of a sliding joint [m]
  double min_speed = 0.0, max_speed = 0.0;                       ///< [m/s]
  bool of_operator = false;  ///< rest: `position` is of the operator's centre of mass
  double max_spin = std::numeric_limits<double>::infinity();  ///< [rad/s]
  double drift_time = 2.0;                                    ///< [s]
};

/// An object of a task and its state at the start of a trial: one body, or a device, whose links are
/// descendants by joints of the one of its name.
struct TaskObject {
  std::string name;
  std::string file;  ///< a URDF with this link: name of a shipped scene, or a path
  Pose start;        ///< of the body; of a device's URDF root; in world
  Twist twist;       ///< world axes; 0 for a fixture
};
using Fixture = TaskObject;  ///< an immovable body

/// A task as written in YAML. Immutable once loaded.
struct Task {
  std::string name, instructions;
  Vector3 gravity = Vector3::Zero();  ///< [m/s^2]
  std::vector<TaskObject> objects;    ///< one for each trial
  std::vector<TaskObject> fixtures;   ///< immovable bodies, in all trials
  std::string scene;         ///< scene whose fixtures and operator are added: a name or a path; empty: none
  bool latin_square = true;  ///< order of objects; false: as listed
  int repetitions = 1;
  bool practice = false;    ///< all objects once before, as repetition 0, which analyses skip
  double time_out = 120.0;  ///< of a trial [s]
  std::vector<Goal> goals;  ///< in order

  std::size_t places() const;                        ///< number of goals in the stage of maintenance
  std::size_t place_number(std::size_t goal) const;  ///< among those, from 1; 0: not one of them
};

/// Finds a task's file: `task` is a path to a YAML file, or a name looked up as DIRECTORY/NAME.yaml. Throws
/// SceneError that lists the known names.
std::string find_task_file(const std::string& task, const std::vector<std::string>& directories);

/// Throws SceneError with one line: file, key, what is allowed.
Task load_task(const std::string& file);

/// Text that tells the participant a goal.
std::string instruction(const Task& task, std::size_t goal, const std::string& object);

}  // namespace mrhi
