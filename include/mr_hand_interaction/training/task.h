#pragma once

#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/joint.h"

namespace mrhi {

/// The three stages of a trial. Numbers are those of TrainingStatus.msg.
enum class TrainingStage : std::uint8_t { manipulation, maintenance, release };
constexpr int kTrainingStages = 3;
const char* to_string(TrainingStage stage);

enum class GoalKind : std::uint8_t {
  pick,        ///< held, and moved by `distance` from where it was at the trial's start
  place,       ///< held within the tolerances
  insert,      ///< the same, with a way to lie
  catch_it,    ///< held for `hold`, and for the first time within `within` of the trial's start
  nudge_into,  ///< not held, in the box and slower than max_speed
  strike,      ///< touched, and on leaving the hand as fast as between min_speed and max_speed (tap, slap)
  joint,       ///< a joint of the object is from `above` to `below`
  rest,        ///< the object or the operator's body is within the tolerances, no faster than max_speed and
               ///< max_spin
  release      ///< let go; ends drift_time later
};
/// As in a task's file; tap and slap are both "strike".
const char* to_string(GoalKind kind);

/// What makes a timer begin anew.
enum class Leaving : std::uint8_t { reset, stop };

/// One thing to be reached. What a kind does not name above is not used for it.
struct Goal {
  GoalKind kind = GoalKind::pick;
  TrainingStage stage = TrainingStage::manipulation;
  std::string instruction;  ///< empty: one made from the rest

  Vector3 position = Vector3::Zero();               ///< of the object's centre of mass, in world [m]
  Quaternion orientation = Quaternion::Identity();  ///< of the object's link
  double tolerance = 0.03;                          ///< [m]; rest without a position: infinite
  std::optional<double> angle_tolerance;            ///< [rad]; nothing: any orientation will do
  std::optional<Vector3> axis;       ///< unit, of the object: it alone is to lie as in `orientation`,
                                     ///< either end first
  Vector3 size = Vector3::Zero();    ///< of the box about `position` [m]
  double hold = 0.0;                 ///< the condition must last this long [s]
  Leaving leaving = Leaving::reset;  ///< what becomes of the time held so far
  double distance = 0.05;            ///< [m]
  std::optional<double> within;      ///< [s] from the trial's start; joint: from the goal's
  std::string joint;                 ///< as the object's URDF names it
  double above = -Joint::kUnlimited, below = Joint::kUnlimited;  ///< [rad], of one that slides [m]
  double min_speed = 0.0, max_speed = 0.0;                       ///< [m/s]
  bool of_operator = false;  ///< rest: `position` is that of the operator's centre of mass
  double max_spin = std::numeric_limits<double>::infinity();  ///< [rad/s]
  double drift_time = 2.0;                                    ///< [s]
};

/// An object of a task and how it is at the start of a trial. It is one body, or a device: links that hang by
/// joints on the one of its name.
struct TaskObject {
  std::string name;
  std::string file;  ///< a URDF with this link: a shipped scene's name, or a path
  Pose start;        ///< of the body, of a device of its URDF's root, in world
  Twist twist;       ///< world axes; of a fixture 0
};
using Fixture = TaskObject;  ///< a body that never moves

/// What a lab writes in YAML. Immutable once loaded.
struct Task {
  std::string name, instructions;
  Vector3 gravity = Vector3::Zero();  ///< [m/s^2]
  std::vector<TaskObject> objects;    ///< one trial has one of them
  std::vector<TaskObject> fixtures;   ///< bodies that never move, there in all trials
  std::string scene;         ///< whose fixtures and operator are there too: a name or a path; empty: none
  bool latin_square = true;  ///< order of objects; else as listed
  int repetitions = 1;
  bool practice = false;    ///< once through all objects before, as repetition 0, which no analysis counts
  double time_out = 120.0;  ///< of a trial [s]
  std::vector<Goal> goals;  ///< one after the other

  std::size_t places() const;                        ///< goals in the stage of maintenance
  std::size_t place_number(std::size_t goal) const;  ///< from 1; 0: none
};

/// The file that `task` means: a path to a YAML file, or a name looked up as DIRECTORY/NAME.yaml. Throws
/// SceneError that lists the names known.
std::string find_task_file(const std::string& task, const std::vector<std::string>& directories);

/// Throws SceneError with one line: file, key, what is allowed.
Task load_task(const std::string& file);

/// What the participant is to do for a goal.
std::string instruction(const Task& task, std::size_t goal, const std::string& object);

}  // namespace mrhi
