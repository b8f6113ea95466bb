#include "mr_hand_interaction/replay/replay.h"

#include <algorithm>

#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "open_bag.h"
#include "run.h"

namespace mrhi {
namespace {

void leave_out(const std::vector<std::string>& hands, ProgressBar& progress, ReplaySummary& summary) {
  if (hands.empty()) return;
  if (summary.hands_left_out == 0) {
    progress.line("replay: left out: " + hands.front() + " (more of the kind are counted only)");
  }
  summary.hands_left_out += hands.size();
}

/// What the recorder's clock says of the stamps to come, as the node's does of those of live frames.
struct RecordersClock {
  Nanoseconds last_stamp = 0;
  std::optional<Nanoseconds> arrival;  // of the frame with the last stamp

  std::optional<Nanoseconds> expected(const std::optional<Nanoseconds>& now) const {
    if (!arrival || !now) return std::nullopt;
    return last_stamp + std::max<Nanoseconds>(0, *now - *arrival);
  }
};

bool is_csv(const std::string& file) {
  return file.compare(file.size() - 4, 4, ".csv") == 0;
}

ReplayInput open_input(const ReplayArguments& arguments) {
  if (is_csv(arguments.input))
    return {std::make_unique<CsvInput>(arguments.input,
                                       arguments.hand_transform.value_or(default_device_mount())),
            ""};
  return open_bag(arguments);
}

/// What a log would tell; it is not asked where the hands are others than those that the simulation took.
OpenLog open_log_of(const ReplayArguments& arguments) {
  OpenLog log;
  log.why_not = "it has hands alone";
  if (is_csv(arguments.input)) return log;
  if (!arguments.topic && !arguments.hand_transform) return open_log(arguments);
  log.why_not = "its hands are taken from another topic, or placed anew";
  return log;
}

}  // namespace

void run_frames(FrameSource& source, Simulation& simulation, ResultWriter& writer, ProgressBar& progress,
                ReplaySummary& summary, const FrameWatcher& watcher) {
  std::optional<Nanoseconds> last_stamp;
  RecordersClock clock;
  while (const std::optional<SourceFrame> input = source.next()) {
    progress.show(source.position(), source.size());
    if (!input->frame) {
      reject(input->reason, input->detail, progress, summary);
      continue;
    }
    const Rejection rejection = simulation.begin(*input->frame, clock.expected(input->arrival));
    if (rejection != Rejection::none) {
      reject(to_string(rejection), "frame " + std::to_string(source.position()) + " of the input", progress,
             summary);
      continue;
    }
    leave_out(input->left_out, progress, summary);
    while (timed_step(simulation, summary)) {
    }
    const FrameResult& result = simulation.end();
    for (const std::string& what : result.not_finite) reject("not finite", what, progress, summary);
    writer.write(result, simulation.state(), gravity_of(simulation));
    if (watcher) watcher(simulation);
    add_result(simulation, last_stamp, summary);
    ++summary.frames;
    last_stamp = result.stamp;
    clock = {result.stamp, input->arrival};
  }
}

void replay(const ReplayArguments& arguments) {
  const OpenLog log = open_log_of(arguments);
  if (log.source) return replay_log(arguments, *log.source, log.topic);
  if (arguments.scene.empty())
    throw UsageError("--scene is missing: " + arguments.input + " does not tell it, as " + log.why_not +
                     "; --help shows the usage");
  Simulation simulation = prepare_simulation(arguments);
  const ReplayInput input = open_input(arguments);
  ResultWriter writer(arguments.output, simulation.scene());
  ReplaySummary summary;
  summary.scene = simulation.scene().name;
  summary.input = arguments.input;
  summary.topic = input.topic;
  summary.arguments = arguments.repeatable;
  tell_setting(simulation, summary);
  summary.not_known = {"scene, parameters and changes of the live run: " + log.why_not};
  ProgressBar progress;
  if (!is_csv(arguments.input)) progress.line("replay: not known: " + summary.not_known.front());
  try {
    run_frames(*input.frames, simulation, writer, progress, summary, marker_watcher(arguments));
    if (summary.frames == 0) throw std::runtime_error(arguments.input + ": no frame that can be used");
    writer.flush();
  } catch (const std::exception& error) {
    summary.error = error.what();
    tell_end(simulation, summary);
    write_summary(arguments.output, summary);
    throw;
  }
  tell_end(simulation, summary);
  write_summary(arguments.output, summary);
}

}  // namespace mrhi
