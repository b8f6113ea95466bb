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

/// The operator's body at one time.
struct OperatorMotion {
  Pose pose;    ///< of the centre of mass in world
  Twist twist;  ///< world axes
};

/// What a trial sees of its object at one time.
struct Observation {
  Nanoseconds stamp = 0;
  Pose pose;                         ///< of the object's body frame in world
  Twist twist;                       ///< world axes
  bool held = false;                 ///< grasped by a hand
  bool touched = false;              ///< by a hand
  std::optional<double> grip_force;  ///< half the sum of the forces that press on the object [N]
  int tracking_losses = 0;           ///< hands lost since the observation before
  int touches = 0;  ///< contacts of a hand with a body that began since the observation before
  std::optional<OperatorMotion> person;  ///< nothing: the scene has no operator
  bool put_back = false;                 ///< left the bounds since then, and was put back where it started
  std::vector<std::pair<std::string, double>> joints;  ///< by name: where it is [rad], [m]
};

/// Of a body of a simulation and what hangs on it, after a frame.
Observation observe(const Simulation& simulation, std::size_t body);

/// Numbers are those of TrainingStatus.msg.
enum class TrialResult : std::uint8_t { none, completed, skipped, timed_out, aborted };
const char* to_string(TrialResult result);  ///< as in trials.csv

/// Columns of trials.csv; what was not measured is empty.
struct TrialMeasures {
  double completion_time = 0.0;                                    ///< [s] until the object was let go
  std::array<std::optional<double>, kTrainingStages> stage_times;  ///< [s]; empty: never got there
  int attempts = 0;  ///< times grasped (nudge_into, strike: touched); `grasps` in trials.csv too
  /// Times lost, for 0.1 s at least, while it should have been held (strike: left at another speed).
  int drops = 0;
  int manipulation_drops = 0;  ///< of the drops those in the stage of manipulation: the paper's attempts
  double path_length = 0.0;    ///< way of the object while held [m]
  std::optional<double> grip_force_mean, grip_force_max;  ///< while held [N]; the mean over time
  std::optional<double> release_drift;                    ///< from where it was let go, drift_time later [m]
  std::optional<double> release_speed;                    ///< as it was let go [m/s]
  int tracking_losses = 0;
  int touches = 0;  ///< times that a hand began to touch an object or a fixture
  /// Of the last goal `rest` with a position: the speed at which its body first came within the tolerance
  /// [m/s]; where it was and how it lay as the goal was achieved [m], [rad].
  std::optional<double> arrival_speed, misplacement, misalignment;
  std::optional<double> operator_speed, operator_spin;  ///< at the trial's end [m/s], [rad/s]
};

enum class TrialEventKind : std::uint8_t {
  begun,
  grasped,
  dropped,
  released,
  reached,        ///< detail: number of the goal, from 1; its timer runs
  left,           ///< detail: the timer [s] as it stopped
  goal_achieved,  ///< detail: number of the goal, from 1
  touched,        ///< for a goal that asks for a touch
  missed,         ///< a strike; detail: the object's speed [m/s]
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

  /// Takes what is seen now. An observation that is not later than the one before is passed over, and so is
  /// all after the end.
  void update(const Observation& seen);
  /// The time until the next observation does not count.
  void pause() { counting_ = false; }
  /// Ends it as skipped or aborted; nothing if it has ended.
  void end(TrialResult result);

  TrialResult result() const { return result_; }  ///< none: goes on
  bool begun() const { return last_.has_value(); }
  std::size_t goal() const { return goal_; }  ///< index in the task's goals
  TrainingStage stage() const { return task_->goals[goal_].stage; }
  bool inside() const { return inside_; }  ///< the goal's condition holds
  double progress() const;                 ///< of the goal's timer, 0 to 1
  double remaining() const;                ///< of the goal's timer [s]
  double elapsed() const { return to_seconds(elapsed_); }
  const TrialMeasures& measures() const { return measures_; }
  /// What the last update() or end() brought about.
  const std::vector<TrialEvent>& events() const { return events_; }

 private:
  struct LettingGo {
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
  Nanoseconds goal_begun_ = 0;                        ///< elapsed as the one before was achieved
  bool counting_ = false;
  std::array<Nanoseconds, kTrainingStages> stage_elapsed_{};

  Vector3 start_ = Vector3::Zero();
  bool inside_ = false;    ///< of the goal's condition
  bool arrived_ = false;   ///< rest: within its tolerance once
  bool touching_ = false;  ///< or it is not long ago
  Nanoseconds timer_ = 0, untouched_ = 0, gripped_ = 0;
  double grip_impulse_ = 0.0;         ///< over gripped_ [N s]
  std::optional<Nanoseconds> loose_;  ///< not held since, while it should be
  std::optional<LettingGo> let_go_;
  TrialMeasures measures_;
  std::vector<TrialEvent> events_;
};

}  // namespace mrhi
