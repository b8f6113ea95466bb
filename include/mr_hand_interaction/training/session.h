#pragma once

#include <cstdint>
#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/training/task.h"
#include "mr_hand_interaction/training/trial.h"

namespace mrhi {

class FolderLock;

/// A session that cannot be opened or written. what() is one line.
class SessionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Content of session.yaml; docs/study.md has its meaning.
struct SessionHeader {
  std::string participant, group, handedness, condition;
  Vector3 gravity = Vector3::Zero();  ///< [m/s^2]
  std::uint64_t seed = 1;
  std::string task;
  bool simulated = false;
  int session = 1;                 ///< of this participant with this task and condition, from 1
  std::string started;             ///< UTC, as 2024-05-06T10:00:00Z
  std::vector<std::string> order;  ///< of objects
  std::string software;
};

/// Setup of a session: bytes of files by name. A session's folder keeps them below setup/, so that a resumed
/// session has the same setup. Empty: nothing is kept.
struct SessionSetup {
  std::map<std::string, std::string> files;
};

/// A row of trials.csv.
struct TrialRow {
  int trial = 0;
  std::string object;
  int repetition = 1;  ///< from 1; 0: practice
  TrialResult result = TrialResult::none;
  double start = 0.0;  ///< since the session's start [s]
  TrialMeasures measures;
};

/// A row of events.csv.
struct EventRow {
  double time = 0.0;      ///< since the session's start [s]
  Nanoseconds stamp = 0;  ///< on the clock of the session
  std::string utc;        ///< as 2024-05-06T10:00:00.123Z; empty: not known
  int trial = 0;          ///< 0: none
  TrainingStage stage = TrainingStage::manipulation;
  std::string event, object, detail;
};

/// A row of hands.csv (filtered) or hands_raw.csv, with the columns that replay gives them: the tip of an
/// index finger.
struct HandRow {
  double time = 0.0;  ///< since the session's start [s]
  bool filtered = false;
  std::uint32_t hand = 0;
  int side = 0;                                            ///< as in Hand.msg
  Vector3 start = Vector3::Zero(), end = Vector3::Zero();  ///< of its last phalanx, in world [m]
  double radius = 0.0;
};

/// A session's folder: session.yaml, setup/, trials.csv, events.csv, and once there are hands hands.csv and
/// hands_raw.csv. A logged row is in the file when the call returns, even if the program crashes then.
class SessionFolder {
 public:
  /// Creates the folder, or resumes an existing session; removes a line that a crash has cut off. Throws
  /// SessionError if the folder is of another session or setup, has other tables of these names, is in use by
  /// another program, or cannot be read or written. Checks everything before it changes anything.
  SessionFolder(const std::string& folder, const SessionHeader& header, const SessionSetup& setup = {});
  ~SessionFolder();

  const std::string& path() const { return path_; }
  bool resumed() const { return resumed_; }
  /// Rows of trials.csv, without measures.
  const std::vector<TrialRow>& earlier_trials() const { return earlier_; }
  int last_trial() const { return last_trial_; }   ///< highest number in either file; 0: none
  double last_time() const { return last_time_; }  ///< of events.csv [s]
  /// Descriptions of removed lines, for the log.
  const std::vector<std::string>& notes() const { return notes_; }

  /// Throws SessionError if an open file was removed or replaced.
  void check_there() const;

  /// Log a row. Throw SessionError likewise, or if the disk is full.
  void log(const EventRow& row);
  void log(const TrialRow& row);
  void log(const HandRow& row);

 private:
  /// A file to which rows are appended, with its identity.
  struct Table {
    std::string file;
    std::ofstream out;
    std::uint64_t device = 0, inode = 0;

    void check_there() const;
    void write(const std::string& text);
  };

  void check(const SessionHeader& header, const SessionSetup& setup) const;
  void open_header(const SessionHeader& header, const SessionSetup& setup);
  std::string open_table(const char* name, const char* columns, Table& table);

  std::string path_, condition_;
  std::unique_ptr<FolderLock> lock_;
  bool resumed_ = false;
  std::vector<TrialRow> earlier_;
  int last_trial_ = 0;
  double last_time_ = 0.0;
  std::vector<std::string> notes_;
  Table trials_, events_, hands_, hands_raw_;
};

/// Numbers are those of TrainingStatus.msg.
enum class SessionPhase : std::uint8_t { ready, running, paused, finished };

/// Functions of the program that runs a session; both may be empty.
struct SessionHooks {
  std::function<std::string()> utc;                   ///< the present time, for EventRow::utc
  std::function<void(const EventRow& row)> on_event;  ///< after each row of events.csv
};

/// Row of a participant in the Latin square, from 0: the number at the end of the name, from 1 ("P07": 6).
/// Throws SessionError for a name without a number.
std::uint64_t participant_place(const std::string& participant);

/// A participant's trials in sequence, and their log. Each combination of object and repetition without a
/// row, or with aborted rows only, is still to be done.
class Session {
 public:
  /// `header`: gravity, task and order are those of the task. `place`: see participant_place. `now`: origin
  /// of times; those of a resumed session continue from its last event.
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
  /// Skips the running trial, or the next one.
  void skip(Nanoseconds now);
  /// Aborts the running trial, which is then the next one. If none is running, repeats the previous one.
  void repeat(Nanoseconds now);
  /// Logs that a parameter of the running system was changed from `setup`, or restored.
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

/// Order in which a participant (counted from 0) meets n things: a row of a Latin square, shuffled by the
/// seed. Among n participants in a row, the first of them a multiple of n, each thing has each place once;
/// among 2 n (n, if n is even) each also follows each other equally often (Williams 1949).
std::vector<std::size_t> latin_square_order(std::size_t n, std::uint64_t participant, std::uint64_t seed);

/// The git revision that this library was built from, with a hash of what was changed since; "unknown" where
/// it was built outside of a repository.
std::string source_revision();

/// task.yaml (the file as it stands), parameters.yaml (every parameter's value; gravity is the task's), the
/// URDF and YAML of each object and fixture, meshes.txt (SHA-256 of the mesh files, if there are any),
/// software.yaml (version and revision) and SHA256SUMS of them all, which `sha256sum -c` reads. Throws
/// SceneError for a file that cannot be read.
SessionSetup session_setup(const std::string& task_file, const Task& task, Configuration configuration,
                           const std::vector<std::string>& scene_folders, const SceneOptions& options,
                           const std::string& version);

/// Writes them to FOLDER/setup, whole or not at all. Throws SessionError.
void write_setup(const std::string& folder, const SessionSetup& setup);

/// Throws SessionError that says where what is in FOLDER/setup differs first, if it does.
void check_same_setup(const std::string& folder, const SessionSetup& setup);

}  // namespace mrhi
