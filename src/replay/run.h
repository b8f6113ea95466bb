#pragma once

#include <functional>
#include <optional>
#include <string>

#include "frame_source.h"
#include "log_source.h"
#include "mr_hand_interaction/replay/replay.h"
#include "progress_bar.h"
#include "result_writer.h"
#include "summary.h"

namespace mrhi {

// What replays of frames and of logs have in common: they run frames, and count.

/// One step, its time noted; false if there is none to make.
bool timed_step(Simulation& simulation, ReplaySummary& summary);
/// As the configuration has it, else the scene [m/s^2].
Vector3 gravity_of(const Simulation& simulation);
/// A frame that has been run, or what came of time without any. `since`: the stamp of the one before.
void add_result(const Simulation& simulation, const std::optional<Nanoseconds>& since,
                ReplaySummary& summary);
/// Counts; the first of each kind is told.
void reject(const std::string& reason, const std::string& detail, ProgressBar& progress,
            ReplaySummary& summary);
/// What the outcome hangs on beside the hands.
void tell_setting(const Simulation& simulation, ReplaySummary& summary);
/// What is held, and the state's hash.
void tell_end(const Simulation& simulation, ReplaySummary& summary);
/// Throws std::runtime_error naming the file if it cannot be written.
void write_summary(const std::string& folder, const ReplaySummary& summary);

/// Who looks at each result.
using FrameWatcher = std::function<void(const Simulation&)>;

/// Runs all frames through the simulation; each result is written. The summary grows as it goes on, so that
/// it holds if this throws.
void run_frames(FrameSource& source, Simulation& simulation, ResultWriter& writer, ProgressBar& progress,
                ReplaySummary& summary, const FrameWatcher& watcher = {});

/// Writes markers.bag, if that is asked for; else nothing.
FrameWatcher marker_watcher(const ReplayArguments& arguments);

/// A folder that is gone with all that is in it when this is.
class ScratchFolder {
 public:
  ScratchFolder();
  ~ScratchFolder();
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Does again what a live simulation did. Throws as replay() does.
void replay_log(const ReplayArguments& arguments, LogSource& log, const std::string& topic);

}  // namespace mrhi
