#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "../record/duration_histogram.h"
#include "inputs.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/replay/replay.h"
#include "mr_hand_interaction/scene/body.h"
#include "tables.h"

namespace mrhi {
/// Comparison of a replay with the live run that it repeats.
struct LiveRun {
  std::string version;                  ///< of the package that ran
  std::uint64_t entries = 0;            ///< of the log that were repeated
  std::uint64_t missing = 0;            ///< entries that the recording has lost
  std::uint64_t compared = 0;           ///< entries after which the state was compared with the live one's
  std::uint64_t same = 0;               ///< of these, with the same hash
  std::optional<double> diverges_at;    ///< time of the first difference [s]
  std::uint64_t lost_by_queue = 0;      ///< frames that did not reach the live simulation
  std::vector<std::string> changes;     ///< made while it ran, with their times
  std::vector<std::string> overridden;  ///< options of the command line that make this a different run
};

/// Content of summary.json.
struct ReplaySummary {
  std::string scene, input, topic, contact_model, version;
  std::vector<std::string> arguments;             ///< that repeat this run
  Vector3 gravity = Vector3::Zero();              ///< [m/s^2]
  std::map<std::string, std::string> parameters;  ///< those that differ from the default, as YAML
  std::map<std::string, Material> materials;      ///< of the objects, by name
  std::uint64_t frames = 0;                       ///< accepted
  double simulated_seconds = 0.0;
  std::uint64_t steps = 0;
  DurationHistogram step_time;
  double deepest_rendered = 0.0;                   ///< [m]
  std::uint64_t restarts = 0;                      ///< number of times that the recording's stamps restarted
  std::map<std::string, std::uint64_t> rejected;   ///< frames, by reason
  std::map<std::string, std::uint64_t> corrected;  ///< corrected faults of the input, by kind
  std::uint64_t hands_left_out = 0;                ///< unusable hands in accepted frames
  std::map<std::string, std::uint64_t> events;
  std::vector<std::string> held_at_end;
  std::uint64_t state_hash = 0;
  std::optional<LiveRun> live;         ///< if the recording has a log
  std::vector<std::string> not_known;  ///< what affects the result but is not in the recording
  std::string error;                   ///< reason for an early end; empty if there was none
};

/// Parameters that differ from the default, as YAML.
std::map<std::string, std::string> changed_parameters(const Configuration& configuration);

/// The summary as JSON. Everything except step_time_us is the same for the same input.
std::string to_json(const ReplaySummary& summary);

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

/// Processes frames, writes results and counts them. The summary is complete at any time.
class ReplayRun {
 public:
  ReplayRun(const ReplayArguments& arguments, const std::string& topic);

  /// Starts or restarts a run. Throws std::runtime_error that names a file that cannot be written.
  void begin(const Simulation& simulation, const std::string& scene);
  /// The scene has changed.
  void follow(const Scene& scene) { writer_->follow(scene); }
  /// Runs a frame and writes its result, or counts it as rejected. `which`: names it in messages.
  bool frame(const HandFrame& hands, const std::optional<Nanoseconds>& expected, const std::string& which,
             Simulation& simulation);
  /// Writes a result: of a frame, or of time without hands.
  void result(const Simulation& simulation);
  /// Writes events of a change between frames.
  void events(const std::vector<Event>& events, const Simulation& simulation);
  /// Counts a rejected frame or change; the first of each kind is printed.
  void reject(const std::string& reason, const std::string& detail);
  /// Counts a corrected fault of the input; the first of each kind is printed.
  void correct(const std::string& kind, const std::string& detail);
  /// Throws std::runtime_error if no frame was accepted, or if the tables cannot be written.
  void check_end();
  /// Writes summary.json, or removes what it has created if there was no frame. `error`: may be empty.
  void end(const Simulation& simulation, const std::string& error);

  bool writes_markers() const { return markers_ != nullptr; }
  /// Since the first result [s].
  double seconds() const;

  ReplaySummary summary;
  ProgressBar progress;

 private:
  void count(const std::vector<Event>& events);
  void first_of_kind(const std::string& text);

  std::string output_;
  std::string created_folder_;  ///< the outermost folder that this run has created; empty: none
  std::unique_ptr<ResultWriter> writer_;
  ViewWriter markers_;
  std::optional<Nanoseconds> first_stamp_, last_stamp_;
  std::vector<double> intervals_;  ///< between accepted frames [s]
};

/// Runs all frames through the simulation.
void run_frames(FrameSource& source, Simulation& simulation, ReplayRun& run);

/// Repeats a live simulation. Throws as replay() does.
void replay_log(const ReplayArguments& arguments, LogSource& log, const std::string& topic);

}  // namespace mrhi
