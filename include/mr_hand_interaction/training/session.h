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

/// Error of a session that cannot be opened or written. what() is one line.
class SessionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Contents of session.yaml; docs/study.md has their meaning.
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

/// Files that define a session, by name with their bytes. A session's folder stores them in setup/, so that a
/// resumed session uses the same. Empty: nothing is stored.
struct SessionSetup {
  std::map<std::string, std::string> files;
};

/// A row of trials.csv.
struct TrialRow {
  int trial = 0;
  std::string object;
  int repetition = 1;  ///< from 1; 0: practice
  TrialResult result = TrialResult::none;
  double start = 0.0;  ///< since the start of the session [s]
  TrialMeasures measures;
};

/// A row of events.csv.
struct EventRow {
  double time = 0.0;      ///< since the start of the session [s]
  Nanoseconds stamp = 0;  ///< on the clock of the session
  std::string utc;        ///< as 2024-05-06T10:00:00.123Z; empty: unknown
  int trial = 0;          ///< 0: none
  TrainingStage stage = TrainingStage::manipulation;
  std::string event, object, detail;
};

/// A row of hands.csv (filtered) or hands_raw.csv, with the columns that replay writes: the tip of an index
/// finger.
struct HandRow {
  double time = 0.0;  ///< since the start of the session [s]
  bool filtered = false;
  std::uint32_t hand = 0;
  int side = 0;                                            ///< as in Hand.msg
  Vector3 start = Vector3::Zero(), end = Vector3::Zero();  ///< of the distal phalanx, in world [m]
  double radius = 0.0;
};

/// A session's folder: session.yaml, setup/, trials.csv, events.csv, and once there are hands, hands.csv and
/// hands_raw.csv. A logged row is in the file when the call returns, even if the program then fails.
class SessionFolder {
 public:
  /// Creates the folder, or resumes the session in it; a line that a crash has truncated is removed. Throws
  /// SessionError if the folder belongs to another session or setup, or has other tables of these names.
  /// Throws also if it is in use by another program, or cannot be read or written. All files are checked
  /// before any is changed.
  SessionFolder(const std::string& folder, const SessionHeader& header, const SessionSetup& setup = {});
  ~SessionFolder();

  const std::string& path() const { return path_; }
  bool resumed() const { return resumed_; }
  /// Rows of trials.csv, without measures.
  const std::vector<TrialRow>& earlier_trials() const { return earlier_; }
  int last_trial() const { return last_trial_; }   ///< highest number in either file; 0: none
  double last_time() const { return last_time_; }  ///< last time in events.csv [s]
  /// Descriptions of removed lines, for the log.
  const std::vector<std::string>& notes() const { return notes_; }

  /// Throws SessionError if the open files are no longer those at their paths.
  void check_there() const;

  /// Throw SessionError, also if writing fails.
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

/// Numbers as in TrainingStatus.msg.
enum class SessionPhase : std::uint8_t { ready, running, paused, finished };

/// Callbacks of a session to its program; both may be empty.
struct SessionHooks {
  std::function<std::string()> utc;                   ///< present time, for EventRow::utc
  std::function<void(const EventRow& row)> on_event;  ///< after each row of events.csv
};

/// Row of a participant in the Latin square, from 0: the number at the end of the name, from 1 ("P07": 7),
/// less one. Throws SessionError for a name without a number.
std::uint64_t participant_place(const std::string& participant);

/// A participant's trials, one after the other, and their log. A combination of object and repetition is
/// still to be done if it has no row, or only aborted ones.
class Session {
 public:
  /// `header`: gravity, task and order are taken from the task. `place`: see participant_place(). `now`:
  /// origin of times; a resumed session continues from its last event.
  Session(Task task, const SessionHeader& header, std::uint64_t place, const std::string& folder,
          Nanoseconds now, const SessionSetup& setup = {}, SessionHooks hooks = {});

  SessionPhase phase() const { return phase_; }
  const Task& task() const { return *task_; }
  const SessionFolder& folder() const { return folder_; }
  std::size_t trials() const { return plan_.size(); }
  std::size_t position() const { return position_; }  ///< index in the plan of the running or next trial
  const TaskObject& object() const;                   ///< of that trial; of the last one if finished
  const Trial& trial() const { return trial_; }       ///< the running one, or the last
  const std::optional<TrialRow>& last() const { return last_; }  ///< the last ended since the start

  /// Starts the next trial, from the first observation on. Requires phase ready.
  void begin(Nanoseconds now);
  /// Requires phase running.
  void update(const Observation& seen);
  /// Logs the path of the fingertip; sets the row's time. Requires phase running and a trial that has begun.
  void log_hand(HandRow row, Nanoseconds stamp);
  /// Requires phase running or paused.
  void pause(bool paused, Nanoseconds now);
  /// Skips the running trial, or the next one.
  void skip(Nanoseconds now);
  /// Aborts the running trial and makes it the next one. If none is running, repeats the previous one.
  void repeat(Nanoseconds now);
  /// Logs that a parameter of the running system now differs from `setup`, or equals it again.
  void note_parameter(const std::string& name, const std::string& value, bool as_begun, Nanoseconds now);
  /// Aborts a running trial, at the end of the program.
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
  void advance_to(std::size_t position);
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

/// Order of n things for a participant (counted from 0): a row of a Latin square, shuffled by the seed. Among
/// n consecutive participants, the first a multiple of n, each thing has each position once. Among 2 n (n, if
/// n is even) each thing also follows each other one equally often (Williams 1949).
std::vector<std::size_t> latin_square_order(std::size_t n, std::uint64_t participant, std::uint64_t seed);

/// Git revision from which this library was built, with a hash of local changes; "unknown" if built outside a
/// repository.
std::string source_revision();

/// Returns task.yaml (unchanged), parameters.yaml (all parameters; gravity is the task's), the URDF and YAML
/// of each object and fixture, meshes.txt (SHA-256 of the mesh files, if any), software.yaml (version and
/// revision) and SHA256SUMS of them all, for `sha256sum -c`. Throws SceneError for a file that cannot be
/// read.
SessionSetup session_setup(const std::string& task_file, const Task& task, Configuration configuration,
                           const std::vector<std::string>& scene_folders, const SceneOptions& options,
                           const std::string& version);

/// Writes the files to FOLDER/setup, all or none. Throws SessionError.
void write_setup(const std::string& folder, const SessionSetup& setup);

/// Throws SessionError with the first difference, if FOLDER/setup differs.
void check_same_setup(const std::string& folder, const SessionSetup& setup);

}  // namespace mrhi
