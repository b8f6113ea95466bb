#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/simulation.h"
#include "mr_hand_interaction/training/task.h"

namespace mrhi {

/// Motion of the operator's body at one time.
struct OperatorMotion {
  Pose pose;    ///< of the centre of mass in world
  Twist twist;  ///< world axes
};

/// Input of a trial at one time.
struct Observation {
  Nanoseconds stamp = 0;
  Pose pose;                         ///< of the object's body frame in world
  Twist twist;                       ///< world axes
  bool held = false;                 ///< grasped by a hand
  bool touched = false;              ///< by a hand
  std::optional<double> grip_force;  ///< half the sum of the normal forces on the object [N]
  int tracking_losses = 0;           ///< hands lost since the last observation
  int touches = 0;                   ///< contacts of a hand with a body that began since the last observation
  std::optional<OperatorMotion> person;  ///< empty: the scene has no operator
  bool put_back = false;                 ///< has since left the bounds and was reset to its start
  std::vector<std::pair<std::string, double>> joints;  ///< names and positions [rad], [m]
};

/// Observes a body of a simulation and its descendants by joints, after a frame.
Observation observe(const Simulation& simulation, std::size_t body);

/// Numbers as in TrainingStatus.msg.
enum class TrialResult : std::uint8_t { none, completed, skipped, timed_out, aborted };
const char* to_string(TrialResult result);  ///< as in trials.csv

/// Columns of trials.csv; values that were not measured are empty.
struct TrialMeasures {
  double completion_time = 0.0;                                    ///< until the object was released [s]
  std::array<std::optional<double>, kTrainingStages> stage_times;  ///< [s]; empty: stage not reached
  int attempts = 0;  ///< number of grasps (nudge_into, strike: touches); also `grasps` in trials.csv
  /// Number of losses of at least 0.1 s while it should be held (strike: released at another speed).
  int drops = 0;
  int manipulation_drops = 0;  ///< drops in the stage of manipulation: the paper's attempts
  double path_length = 0.0;    ///< of the object while held [m]
  std::optional<double> grip_force_mean, grip_force_max;  ///< while held [N]; mean over time
  std::optional<double> release_drift;                    ///< from the place of release, drift_time later [m]
  std::optional<double> release_speed;                    ///< at release [m/s]
  int tracking_losses = 0;
  int touches = 0;  ///< number of first touches of a hand with an object or a fixture
  /// For the last goal `rest` with a position: speed at which its body first came within the tolerance [m/s];
  /// errors of position and orientation when the goal was achieved [m], [rad].
  std::optional<double> arrival_speed, misplacement, misalignment;
  std::optional<double> operator_speed, operator_spin;  ///< at the end of the trial [m/s], [rad/s]
};

enum class TrialEventKind : std::uint8_t {
  begun,
  grasped,
  dropped,
  released,
  reached,        ///< detail: number of the goal, from 1; its timer starts
  left,           ///< detail: the timer [s] when it stopped
  goal_achieved,  ///< detail: number of the goal, from 1
  touched,        ///< for a goal that requires a touch
  missed,         ///< a strike at another speed; detail: the object's speed [m/s]
  tracking_lost,
  put_back,
  ended
};
const char* to_string(TrialEventKind kind);

struct TrialEvent {
  Nanoseconds stamp = 0;
  TrainingStage stage = TrainingStage::manipulation;
  TrialEventKind kind = TrialEventKind::begun;
  double detail = 0.0;
};

/// One object through the goals of a task. Time is that of the observations; the trial begins at the first.
/// Copyable; keeps a pointer to the task.
class Trial {
 public:
  explicit Trial(const Task& task) : task_(&task) {}

  /// Processes an observation. Ignores one that is not later than the last, and all after the end.
  void update(const Observation& seen);
  /// Excludes the time until the next observation.
  void pause() { counting_ = false; }
  /// Ends the trial as skipped or aborted; no effect if it has ended.
  void end(TrialResult result);

  TrialResult result() const { return result_; }  ///< none: not ended
  bool begun() const { return last_.has_value(); }
  std::size_t goal() const { return goal_; }  ///< index in the task's goals
  TrainingStage stage() const { return task_->goals[goal_].stage; }
  bool inside() const { return inside_; }  ///< the goal's condition holds
  double progress() const;                 ///< of the goal's timer, 0 to 1
  double remaining() const;                ///< of the goal's timer [s]
  double elapsed() const { return to_seconds(elapsed_); }
  const TrialMeasures& measures() const { return measures_; }
  /// Events of the last update() or end().
  const std::vector<TrialEvent>& events() const { return events_; }

 private:
  struct ReleaseStart {
    Nanoseconds elapsed;
    Vector3 position;
  };

  const Goal& current_goal() const { return task_->goals[goal_]; }
  double timed() const;
  void measure(const Observation& seen, Nanoseconds passed);
  void note_grasp(const Observation& seen);
  void hold(const Observation& seen, Nanoseconds passed);
  bool too_late() const;
  void note_touch(const Observation& seen, Nanoseconds passed);
  void strike(const Observation& seen);
  void note_drop();
  void note_rest(const Observation& seen, bool achieved);
  void release(const Observation& seen);
  Vector3 position_at(Nanoseconds elapsed, const Observation& seen) const;
  void achieve();
  void finish(TrialResult result);
  void add(TrialEventKind kind, double detail = 0.0);

  const Task* task_;
  std::size_t goal_ = 0;
  TrialResult result_ = TrialResult::none;
  std::optional<Observation> last_;
  Nanoseconds stamp_ = 0, elapsed_ = 0, before_ = 0;  ///< before_: elapsed at the last observation
  Nanoseconds goal_begun_ = 0;                        ///< elapsed_ when the last goal was achieved
  bool counting_ = false;
  std::array<Nanoseconds, kTrainingStages> stage_elapsed_{};

  Vector3 start_ = Vector3::Zero();
  bool inside_ = false;    ///< of the goal's condition
  bool arrived_ = false;   ///< rest: within its tolerance once
  bool touching_ = false;  ///< now or shortly before
  Nanoseconds timer_ = 0, untouched_ = 0, gripped_ = 0;
  double grip_impulse_ = 0.0;                   ///< over gripped_ [N s]
  std::optional<Nanoseconds> ungrasped_since_;  ///< not held since, although it should be
  std::optional<ReleaseStart> released_;
  TrialMeasures measures_;
  std::vector<TrialEvent> events_;
};

}  // namespace mrhi
