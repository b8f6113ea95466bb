#include "mr_hand_interaction/replay/replay.h"

#include <algorithm>
#include <chrono>
#include <fstream>

#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "open_bag.h"

namespace mrhi {
namespace {

bool timed_step(Simulation& simulation, ReplaySummary& summary) {
  const auto begin = std::chrono::steady_clock::now();
  if (!simulation.step()) return false;
  const auto time = std::chrono::steady_clock::now() - begin;
  summary.step_time.add(std::chrono::duration_cast<std::chrono::nanoseconds>(time).count());
  ++summary.steps;
  return true;
}

void add(const Simulation& simulation, Nanoseconds since, ReplaySummary& summary) {
  const FrameResult& result = simulation.result();
  ++summary.frames;
  summary.deepest_rendered = std::max(summary.deepest_rendered, simulation.deepest_rendered());
  for (const Event& event : result.events) ++summary.events[event_name(event.kind)];
  if (result.restarted) ++summary.restarts;
  if (summary.frames > 1 && !result.restarted) summary.simulated_seconds += to_seconds(result.stamp - since);
}

/// Counts; the first of each kind is told.
void reject(const std::string& reason, const std::string& detail, ProgressBar& progress,
            ReplaySummary& summary) {
  if (++summary.rejected[reason] > 1) return;
  progress.line("replay: frame rejected: " + reason + ": " + detail + " (more of the kind are counted only)");
}

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

ReplayInput open_input(const ReplayArguments& arguments) {
  const std::string& file = arguments.input;
  if (file.compare(file.size() - 4, 4, ".csv") == 0) {
    return {std::make_unique<CsvInput>(file, arguments.hand_transform.value_or(default_device_mount())), ""};
  }
  return open_bag(arguments);
}

void finish(const Simulation& simulation, ReplaySummary& summary) {
  const Scene& scene = simulation.scene();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (is_held(i, simulation.state())) summary.held_at_end.push_back(scene.bodies[i].name);
  }
  summary.state_hash = hash(simulation.state());
}

/// What the outcome hangs on beside the hands.
void tell_setting(const Simulation& simulation, ReplaySummary& summary) {
  const Configuration& configuration = simulation.configuration();
  summary.contact_model = configuration.contact_model.name;
  summary.version = MR_HAND_INTERACTION_VERSION;
  summary.gravity = configuration.gravity.value_or(simulation.scene().gravity);
  for (const std::string& name : parameter_names()) {
    const std::string text = parameter_text(configuration, name);
    if (text != parameter_text(Configuration(), name)) summary.parameters[name] = text;
  }
  for (const Body& body : simulation.scene().bodies) summary.materials[body.name] = body.material;
}

void write_summary(const std::string& folder, const ReplaySummary& summary) {
  const std::string path = folder + "/summary.json";
  std::ofstream file(path);
  file << to_json(summary) << std::flush;
  if (!file) throw std::runtime_error("cannot write " + path);
}

}  // namespace

void run_frames(FrameSource& source, Simulation& simulation, ResultWriter& writer, ProgressBar& progress,
                ReplaySummary& summary) {
  Nanoseconds last_stamp = 0;
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
    writer.write(result, simulation.state());
    add(simulation, last_stamp, summary);
    last_stamp = result.stamp;
    clock = {last_stamp, input->arrival};
  }
}

void replay(const ReplayArguments& arguments) {
  Simulation simulation = prepare_simulation(arguments);
  const ReplayInput input = open_input(arguments);
  ResultWriter writer(arguments.output, simulation.scene());
  ReplaySummary summary;
  summary.scene = simulation.scene().name;
  summary.input = arguments.input;
  summary.topic = input.topic;
  tell_setting(simulation, summary);
  ProgressBar progress;
  try {
    run_frames(*input.frames, simulation, writer, progress, summary);
    if (summary.frames == 0) throw std::runtime_error(arguments.input + ": no frame that can be used");
    writer.flush();
  } catch (const std::exception& error) {
    summary.error = error.what();
    finish(simulation, summary);
    write_summary(arguments.output, summary);
    throw;
  }
  finish(simulation, summary);
  write_summary(arguments.output, summary);
}

}  // namespace mrhi
