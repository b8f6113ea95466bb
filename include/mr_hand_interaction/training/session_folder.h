#pragma once

#include <cstdint>
#include <fstream>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "mr_hand_interaction/training/session_setup.h"
#include "mr_hand_interaction/training/trial.h"

namespace mrhi {

class FolderLock;

/// A session that cannot be opened or written. what() is one line.
class SessionError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What session.yaml says; docs/study.md has its meaning.
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
/// hands_raw.csv. What is logged is in the file when the call returns, whatever becomes of this program.
class SessionFolder {
 public:
  /// Makes the folder, or goes on with the one that is there: a line that a crash has cut off is taken away.
  /// Throws SessionError if it is that of another session or of another setup, has other tables of these
  /// names, is in use by another program, or cannot be read or written. All that is there is looked at before
  /// anything is touched.
  SessionFolder(const std::string& folder, const SessionHeader& header, const SessionSetup& setup = {});
  ~SessionFolder();

  const std::string& path() const { return path_; }
  bool resumed() const { return resumed_; }
  /// What was in trials.csv: without measures.
  const std::vector<TrialRow>& earlier_trials() const { return earlier_; }
  int last_trial() const { return last_trial_; }   ///< highest number in either file; 0: none
  double last_time() const { return last_time_; }  ///< of events.csv [s]
  /// What was taken away, for the log.
  const std::vector<std::string>& notes() const { return notes_; }

  /// Throws SessionError once the files that are written to are no more what is found under their names.
  void check_there() const;

  /// These throw SessionError, too, if the disk does not take it.
  void log(const EventRow& row);
  void log(const TrialRow& row);
  void log(const HandRow& row);

 private:
  /// A file that rows are added to, and which one it is.
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

}  // namespace mrhi
