#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "frame_source.h"
#include "marker_bag.h"
#include "mr_hand_interaction/replay/replay.h"
#include "result_writer.h"
#include "summary.h"

namespace mrhi {

/// A progress bar on stderr if that is a terminal; lines written through it stay readable.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();

  void show(std::size_t position, std::size_t size);
  void line(const std::string& text);

 private:
  void wipe();

  bool is_terminal_;
  int percent_ = -1;
};

/// What replays of frames and of logs share: they take frames, write results and count. The summary is
/// complete at any time, so that it can be written if the recording cannot be read any further.
class ReplayRun {
 public:
  ReplayRun(const ReplayArguments& arguments, const std::string& topic);

  /// The simulation starts, or starts again: makes the folder's tables, and sets what the summary says of
  /// scene and parameters. Throws std::runtime_error naming what cannot be written.
  void begin(const Simulation& simulation, const std::string& scene);
  /// The scene has changed.
  void follow(const Scene& scene) { writer_->follow(scene); }
  /// Runs all steps of a frame and writes its result. Counts it as rejected if it is refused; `which`: its
  /// place in the recording, for people.
  bool frame(const HandFrame& hands, const std::optional<Nanoseconds>& expected, const std::string& which,
             Simulation& simulation);
  /// Writes a result: of a frame, or of time without hands.
  void result(const Simulation& simulation);
  /// Counts a rejected frame or change; the first of each kind is printed.
  void reject(const std::string& reason, const std::string& detail);
  /// Counts a fault of the input that was put right; the first of each kind is printed.
  void correct(const std::string& kind, const std::string& detail);
  /// Throws std::runtime_error if no frame was taken, or if the disk does not take the tables.
  void check_end();
  /// Writes summary.json; `error`: why the run ended early, or empty. If it ended before its first frame,
  /// removes the folders that it has made instead.
  void end(const Simulation& simulation, const std::string& error);

  /// Since the first result [s].
  double seconds() const;

  ReplaySummary summary;
  ProgressBar progress;

 private:
  std::string output_;
  std::string made_;  ///< the outermost folder that this run has made; empty: none
  std::unique_ptr<ResultWriter> writer_;
  std::unique_ptr<MarkerBag> markers_;
  std::optional<Nanoseconds> first_stamp_, last_stamp_;
};

/// Runs all frames through the simulation.
void run_frames(FrameSource& source, Simulation& simulation, ReplayRun& run);

/// Repeats what a live simulation did. Throws as replay() does.
void replay_log(const ReplayArguments& arguments, LogSource& log, const std::string& topic);

}  // namespace mrhi
