#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/training/session_folder.h"
#include "mr_hand_interaction/training/task.h"
#include "mr_hand_interaction/training/trial.h"

namespace mrhi {

/// Numbers are those of TrainingStatus.msg.
enum class SessionPhase : std::uint8_t { ready, running, paused, finished };

/// What a session asks of and tells to the program that runs it; both may be empty.
struct SessionHooks {
  std::function<std::string()> utc;                   ///< what time it is, for EventRow::utc
  std::function<void(const EventRow& row)> on_event;  ///< after each row of events.csv
};

/// Place of a participant in the Latin square: the number at the end of the name ("P07": 7), counted from 0
/// where it is counted from 1 by people. Throws SessionError for a name without one.
std::uint64_t participant_place(const std::string& participant);

/// A participant's trials, one after the other, and their log. Each combination of object and repetition that
/// has no row yet, or only rows that say aborted, is still to be done.
class Session {
 public:
  /// `header`: gravity, task and order are those of the task. `place`: see participant_place. `now`: stamps
  /// are counted from here; a session that goes on counts on from its last event.
  Session(Task task, const SessionHeader& header, std::uint64_t place, const std::string& folder,
          Nanoseconds now, const SessionSetup& setup = {}, SessionHooks hooks = {});

  SessionPhase phase() const { return phase_; }
  const Task& task() const { return *task_; }
  const SessionFolder& folder() const { return folder_; }
  std::size_t trials() const { return plan_.size(); }
  std::size_t position() const { return position_; }  ///< in the plan, of the trial that is running or next
  const TaskObject& object() const;                   ///< of that trial; of the last one when finished
  const Trial& trial() const { return trial_; }       ///< the running one, or the last
  const std::optional<TrialRow>& last() const { return last_; }  ///< the last that has ended since the start

  /// Phase ready: the next trial runs, from the first observation on.
  void begin(Nanoseconds now);
  /// Phase running.
  void update(const Observation& seen);
  /// Phase running, once the trial has begun: for the path of the fingertip. The row's time is set here.
  void log_hand(HandRow row, Nanoseconds stamp);
  /// Running and paused only.
  void pause(bool paused, Nanoseconds now);
  /// The running trial, or the next one, is passed over.
  void skip(Nanoseconds now);
  /// The running trial is aborted and is the next one; if none is running, the one before is to be done
  /// again.
  void repeat(Nanoseconds now);
  /// A parameter of the running system is from now on another one than `setup` says, or that one again.
  void note_parameter(const std::string& name, const std::string& value, bool as_begun, Nanoseconds now);
  /// For the end of the program: a running trial is aborted.
  void abort(Nanoseconds now);

 private:
  struct Planned {
    std::size_t object;
    int repetition;
    bool done;
  };

  double time(Nanoseconds stamp) const;
  const Planned& planned() const;
  bool active() const { return phase_ == SessionPhase::running || phase_ == SessionPhase::paused; }
  void end(TrialResult result, Nanoseconds now);
  void go_on_from(std::size_t position);
  void log_trial_events();
  void log_event(const char* event, Nanoseconds now, const std::string& detail = "");
  void log(EventRow row);
  void note_result();

  std::unique_ptr<const Task> task_;
  std::vector<Planned> plan_;
  SessionFolder folder_;
  SessionHooks hooks_;
  Nanoseconds first_;
  SessionPhase phase_ = SessionPhase::ready;
  std::size_t position_ = 0;
  int number_;
  double start_ = 0.0;
  Trial trial_;
  std::optional<TrialRow> last_;
};

}  // namespace mrhi
