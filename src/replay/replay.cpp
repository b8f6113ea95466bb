#include "mr_hand_interaction/replay/replay.h"

#include <algorithm>
#include <stdexcept>

#include "../collision/overlap.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "run.h"

namespace mrhi {
namespace {

Configuration configured(const ReplayArguments& arguments) {
  Configuration configuration;
  if (arguments.parameter_file) load_parameters(configuration, *arguments.parameter_file);
  try {
    for (const auto& [name, value] : arguments.settings) set_parameter(configuration, name, value);
    validate(configuration);
  } catch (const ParameterError& error) {
    throw UsageError(error.what());
  }
  return configuration;
}

Body& object_of(Scene& scene, const std::string& option, const std::string& name) {
  try {
    return free_body(scene, name);
  } catch (const std::invalid_argument& error) {
    throw UsageError(option + ": " + error.what());
  }
}

void place(Scene& scene, const std::string& name, const Pose& pose) {
  Body& body = object_of(scene, "--object-pose", name);
  const Bounds& bounds = scene.bounds;
  if ((pose.position.array() < bounds.min.array()).any() ||
      (pose.position.array() > bounds.max.array()).any()) {
    throw UsageError("--object-pose " + name + ": is out of the scene's bounds");
  }
  body.start = pose;
}

void leave_out(const std::vector<std::string>& hands, ReplayRun& run) {
  if (hands.empty()) return;
  if (run.summary.hands_left_out == 0)
    run.progress.line("replay: left out: " + hands.front() + " (more of the kind are counted only)");
  run.summary.hands_left_out += hands.size();
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
    return {
        std::make_unique<CsvInput>(arguments.input, arguments.hand_transform.value_or(default_device_mount()),
                                   arguments.hands.scale),
        ""};
  return open_bag(arguments);
}

/// The log of the live simulation; it is not read if other hands are asked for than the simulation took.
OpenLog open_log_of(const ReplayArguments& arguments) {
  OpenLog log;
  log.why_not = "it has hands alone";
  if (is_csv(arguments.input)) return log;
  const HandOptions& hands = arguments.hands;
  const bool as_recorded = hands.topics.empty() && hands.order.empty() && hands.scale == 1.0;
  if (as_recorded && !arguments.topic && !arguments.hand_transform) return open_log(arguments);
  log.why_not = "its hands are taken from another topic, or placed anew";
  return log;
}

}  // namespace

Simulation prepare_simulation(const ReplayArguments& arguments) {
  const Configuration configuration = configured(arguments);
  std::string file;
  try {
    file = find_scene_file(arguments.scene, scene_folders());
  } catch (const SceneError& error) {
    throw UsageError(std::string("--scene: ") + error.what());
  }
  Scene scene = load_scene(file, scene_options(configuration));
  for (const auto& [name, pose] : arguments.object_poses) place(scene, name, pose);
  const std::string overlaps = arguments.object_poses.empty() ? "" : overlaps_at_start(scene);
  if (!overlaps.empty()) throw UsageError("--object-pose: " + overlaps + "; allowed: places that are free");
  for (const auto& [name, twist] : arguments.object_twists) {
    object_of(scene, "--object-twist", name).start_twist = twist;
  }
  return Simulation(std::move(scene), configuration);
}

void run_frames(FrameSource& source, Simulation& simulation, ReplayRun& run) {
  RecordersClock clock;
  while (const std::optional<SourceFrame> input = source.next()) {
    run.progress.show(source.position(), source.size());
    for (const auto& [kind, what] : input->corrected) run.correct(kind, what);
    if (!input->frame) {
      run.reject(input->reason, input->detail);
      continue;
    }
    const std::string which = "frame " + std::to_string(source.position()) + " of the input";
    if (!run.frame(*input->frame, clock.expected(input->arrival), which, simulation)) continue;
    leave_out(input->left_out, run);
    clock = {simulation.result().stamp, input->arrival};
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
  ReplayRun run(arguments, input.topic);
  for (const std::string& warning : simulation.scene().warnings) run.progress.line("replay: " + warning);
  run.begin(simulation, simulation.scene().name);
  run.summary.not_known = {"scene, parameters and changes of the live run: " + log.why_not};
  if (!is_csv(arguments.input))
    run.progress.line("replay: runs the hands of " + arguments.input + " through scene '" +
                      simulation.scene().name + "' with the parameters given here, as " + log.why_not);
  try {
    run_frames(*input.frames, simulation, run);
    run.check_end();
  } catch (const std::exception& error) {
    run.end(simulation, error.what());
    throw;
  }
  run.end(simulation, "");
}

}  // namespace mrhi
