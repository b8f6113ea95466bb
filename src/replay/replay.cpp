#include "mr_hand_interaction/replay/replay.h"

#include <stdlib.h>

#include <algorithm>
#include <cctype>
#include <cinttypes>
#include <filesystem>
#include <stdexcept>

#include "../collision/overlap.h"
#include "../record/record.h"
#include "../simulation/state_bytes.h"
#include "../text/files.h"
#include "../text/text.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "run.h"

namespace mrhi {
namespace {

/// A temporary folder that is removed with its contents at the end.
class ScratchFolder {
 public:
  /// `name`: of the program, as a prefix. Throws std::runtime_error if the folder cannot be made.
  explicit ScratchFolder(const std::string& name)
      : path_((std::filesystem::temp_directory_path() / (name + "_XXXXXX")).string()) {
    if (mkdtemp(&path_[0]) == nullptr) throw std::runtime_error("cannot make a folder " + path_);
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

/// Throws UsageError.
std::string scene_file(const ReplayArguments& arguments) {
  return rethrown<UsageError, SceneError>("--scene: ",
                                          [&] { return find_scene_file(arguments.scene, scene_folders()); });
}

/// Arguments of the command line that override what was recorded.
class Overrides {
 public:
  explicit Overrides(const ReplayArguments& arguments) : arguments_(arguments) {}

  /// Names what differs from the recording.
  void apply(World& world) {
    differing_.clear();
    other_scene_ = false;
    if (!arguments_.scene.empty()) take_scene(world);
    if (arguments_.parameter_file) {
      Configuration configuration;
      load_parameters(configuration, *arguments_.parameter_file);
      for (const auto& [name, text] : changed_parameters(configuration)) take_parameter(name, text, world);
    }
    for (const auto& [name, value] : arguments_.settings) take_parameter(name, value, world);
  }

  void place(Simulation& simulation) {
    SimulationState state = simulation.state();
    for (const auto& [name, pose] : arguments_.object_poses) {
      BodyState& body = body_of("--object-pose", name, simulation.scene(), state);
      body.pose = pose;
      differing_.push_back("--object-pose " + name);
    }
    for (const auto& [name, twist] : arguments_.object_twists) {
      BodyState& body = body_of("--object-twist", name, simulation.scene(), state);
      Body moving = simulation.scene().bodies[*find_body(simulation.scene(), name)];
      moving.start = body.pose;
      moving.start_twist = twist;
      body = start_state(moving);
      differing_.push_back("--object-twist " + name);
    }
    simulation.set_state(state);
  }

  bool holds(const std::string& parameter) const { return fixed_.count(parameter) > 0; }
  bool other_scene() const { return other_scene_; }
  const std::vector<std::string>& differing() const { return differing_; }

 private:
  void take_scene(World& world) {
    const std::string file = scene_file(arguments_);
    World requested = world_of_file(file, load_scene(file, scene_options({})), Configuration());
    const auto same = [](const RecordedFile& a, const RecordedFile& b) {
      return a.name == b.name && a.bytes() == b.bytes();
    };
    if (requested.files.size() <= world.files.size() &&
        std::equal(requested.files.begin(), requested.files.end(), world.files.begin(), same))
      return;
    requested.parameters = world.parameters;
    requested.version = world.version;
    world = requested;
    other_scene_ = true;
    differing_.push_back("--scene " + arguments_.scene);
  }

  void take_parameter(const std::string& name, const std::string& value, World& world) {
    Configuration configuration;
    rethrown<UsageError, ParameterError>("", [&] { set_parameter(configuration, name, value); });
    const std::string text = parameter_text(configuration, name);
    std::string& recorded = world.parameters[name];
    if (recorded != text) differing_.push_back(name + "=" + text + " instead of " + recorded);
    recorded = text;
    fixed_.insert(name);
  }

  static BodyState& body_of(const char* option, const std::string& name, const Scene& scene,
                            SimulationState& state) {
    const auto body = find_body(scene, name);
    if (!body || scene.bodies[*body].fixed)
      throw UsageError(std::string(option) + ": no free object '" + name + "' as the recording begins");
    return state.bodies[*body];
  }

  const ReplayArguments& arguments_;
  std::set<std::string> fixed_;
  bool other_scene_ = false;
  std::vector<std::string> differing_;
};

class LogRun {
 public:
  LogRun(const ReplayArguments& arguments, const std::string& topic)
      : arguments_(arguments), overrides_(arguments), run_(arguments, topic) {
    run_.summary.live.emplace();
  }

  void all(LogSource& log) {
    while (const std::optional<LogEntry> entry = log.next()) {
      run_.progress.show(log.position(), log.size());
      take(*entry);
    }
    if (!simulation_) throw std::runtime_error(arguments_.input + ": the recording has no beginning");
    run_.check_end();
  }

  /// Also called after an early end.
  void end(const std::string& error) {
    if (!simulation_) return;
    run_.end(simulation(), error);
    const auto line = [&](const std::string& text) { run_.progress.line("replay: " + text); };
    if (live().diverges_at) line("diverges from the live run at " + text::number(*live().diverges_at) + " s");
    for (const std::string& what : live().overridden) line("not as recorded: " + what);
    for (const std::string& what : run_.summary.not_known) line("not known: " + what);
    if (live().missing > 0) line("the recording has lost " + std::to_string(live().missing) + " entries");
  }

 private:
  Simulation& simulation() { return simulation_->simulation(); }
  LiveRun& live() { return *run_.summary.live; }
  /// markers.bag names the meshes' files, so they stay beside it.
  std::string files_folder() const {
    return run_.writes_markers() ? arguments_.output + "/files" : scratch_.path();
  }

  void take(const LogEntry& entry) {
    if (entry.kind == LogEntry::Kind::begin) return begin(entry);
    if (!simulation_) return;  // before the first BEGIN
    if (entry.run != live_run_) {
      broken_ = true;  // until the next BEGIN
      return;
    }
    if (entry.sequence <= sequence_) return;
    if (entry.sequence != sequence_ + 1) {
      live().missing += entry.sequence - sequence_ - 1;
      broken_ = true;
    }
    sequence_ = entry.sequence;
    live().lost_by_queue = entry.lost - lost_before_;
    ++live().entries;
    if (entry.kind == LogEntry::Kind::frame) frame(entry);
    if (entry.kind == LogEntry::Kind::without_hands) without_hands(entry);
    if (entry.kind == LogEntry::Kind::change) change(entry);
    compare(entry);
  }

  void begin(const LogEntry& entry) {
    const bool known = simulation_ && entry.run == live_run_;
    if (known && entry.sequence > sequence_) live().missing += entry.sequence - sequence_;
    if (known && !broken_ && entry.sequence <= sequence_) return;
    if (!known) lost_before_ = entry.lost;
    live_run_ = entry.run;
    sequence_ = entry.sequence;
    broken_ = false;
    World world = world_from_yaml(entry.text, entry.files);
    overrides_.apply(world);
    const Configuration configuration = configuration_of(world, run_.summary.not_known);
    simulation_ = std::make_unique<LiveSimulation>(
        scene_of(world, scene_options(configuration), files_folder()), configuration);
    if (!overrides_.other_scene()) take_state(entry);
    overrides_.place(simulation());
    note_begin(world);
    compare(entry);
  }

  void take_state(const LogEntry& entry) {
    try {
      simulation().set_state(state_from_bytes(entry.state, simulation().scene()));
    } catch (const std::invalid_argument& error) {
      run_.summary.not_known.push_back(std::string("where things were as the recording began: ") +
                                       error.what());
    }
  }

  void note_begin(const World& world) {
    run_.begin(simulation(), world.scene);
    if (!hashes_)
      hashes_ = std::make_unique<CsvFile>(arguments_.output + "/hashes.csv", table_of("hashes.csv").header());
    live().version = world.version;
    live().overridden = overrides_.differing();
    if (world.version != run_.summary.version)
      run_.summary.not_known.push_back("what version " + world.version + " did otherwise than this one, " +
                                       run_.summary.version);
  }

  void frame(const LogEntry& entry) {
    if (!entry.hands) return run_.reject("unusable hand", entry.text);
    run_.frame(*entry.hands, entry.expected, "entry " + std::to_string(entry.sequence), simulation());
  }

  void without_hands(const LogEntry& entry) {
    if (simulation().advance_without_hands(entry.time)) run_.result(simulation());
  }

  void change(const LogEntry& entry) {
    Change change = change_from_yaml(entry.text, entry.files);
    live().changes.push_back(text::format("%.3f s: ", run_.seconds()) + text::one_line(to_text(change), 200));
    if (auto* set = std::get_if<SetParameters>(&change)) drop_overridden(*set);
    try {
      SceneOptions options = scene_options(simulation().configuration());
      options.mesh_files = written_to(files_folder(), entry.files);
      prepare(change, options);
      run_.events(events_ended_by(change, *simulation_), simulation());
      apply_change(change, *simulation_);
    } catch (const std::exception& error) {
      run_.reject("change", error.what());
    }
    run_.follow(simulation().scene());
  }

  void drop_overridden(SetParameters& set) const {
    set.values.erase(std::remove_if(set.values.begin(), set.values.end(),
                                    [&](const auto& value) { return overrides_.holds(value.first); }),
                     set.values.end());
  }

  void compare(const LogEntry& entry) {
    const std::uint64_t here = hash(simulation().state());
    hashes_->row(std::to_string(entry.sequence), std::to_string(entry.stamp),
                 text::format("%016" PRIx64, here));
    if (broken_ || !overrides_.differing().empty()) return;
    ++live().compared;
    if (here == entry.state_hash) ++live().same;
    if (here != entry.state_hash && !live().diverges_at) live().diverges_at = run_.seconds();
  }

  const ReplayArguments& arguments_;
  Overrides overrides_;
  ScratchFolder scratch_{"replay"};
  ReplayRun run_;
  std::unique_ptr<LiveSimulation> simulation_;
  std::unique_ptr<CsvFile> hashes_;
  std::uint64_t live_run_ = 0, sequence_ = 0, lost_before_ = 0;
  bool broken_ = false;  ///< entries are missing, so that states cannot be compared
};

Configuration configured(const ReplayArguments& arguments) {
  Configuration configuration;
  if (arguments.parameter_file) load_parameters(configuration, *arguments.parameter_file);
  rethrown<UsageError, ParameterError>("", [&] {
    for (const auto& [name, value] : arguments.settings) set_parameter(configuration, name, value);
    validate(configuration);
  });
  return configuration;
}

Body& object_of(Scene& scene, const std::string& option, const std::string& name) {
  return rethrown<UsageError, std::invalid_argument>(option + ": ",
                                                     [&]() -> Body& { return free_body(scene, name); });
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

/// Of a file that ends in .bag or .csv.
bool is_csv(const std::string& file) {
  return std::tolower(static_cast<unsigned char>(file.back())) == 'v';
}

ReplayInput open_input(const ReplayArguments& arguments) {
  if (is_csv(arguments.input)) {
    auto table = std::make_unique<CsvInput>(
        arguments.input, arguments.hand_transform.value_or(default_device_mount()), arguments.hands.scale);
    std::vector<std::string> warnings = table->warnings();
    return {std::move(table), "", std::move(warnings)};
  }
  return open_bag(arguments.input, arguments.topic, arguments.hand_transform, arguments.hands);
}

/// The log, unless the arguments ask for other hands than the live simulation took.
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

void replay_log(const ReplayArguments& arguments, LogSource& log, const std::string& topic) {
  LogRun run(arguments, topic);
  try {
    run.all(log);
  } catch (const std::exception& error) {
    run.end(error.what());
    throw;
  }
  run.end("");
}

Simulation prepare_simulation(const ReplayArguments& arguments) {
  const Configuration configuration = configured(arguments);
  Scene scene = load_scene(scene_file(arguments), scene_options(configuration));
  for (const auto& [name, pose] : arguments.object_poses) place(scene, name, pose);
  const std::string overlaps = arguments.object_poses.empty() ? "" : overlaps_at_start(scene);
  if (!overlaps.empty()) throw UsageError("--object-pose: " + overlaps + "; allowed: places that are free");
  for (const auto& [name, twist] : arguments.object_twists) {
    object_of(scene, "--object-twist", name).start_twist = twist;
  }
  return Simulation(std::move(scene), configuration);
}

void run_frames(FrameSource& source, Simulation& simulation, ReplayRun& run) {
  std::optional<Nanoseconds> arrival;  // of the last frame, by the recorder's clock
  while (const std::optional<SourceFrame> input = source.next()) {
    run.progress.show(source.position(), source.size());
    for (const auto& [kind, what] : input->corrected) run.correct(kind, what);
    if (!input->frame) {
      run.reject(input->reason, input->detail);
      continue;
    }
    const std::string which = "frame " + std::to_string(source.position()) + " of the input";
    std::optional<Nanoseconds> expected;  // stamp, as the node predicts it for live frames
    if (arrival && input->arrival)
      expected = simulation.result().stamp + std::max<Nanoseconds>(0, *input->arrival - *arrival);
    if (!run.frame(*input->frame, expected, which, simulation)) continue;
    if (!input->left_out.empty() && run.summary.hands_left_out == 0)
      run.progress.line("replay: left out: " + input->left_out.front() +
                        " (more of the kind are counted only)");
    run.summary.hands_left_out += input->left_out.size();
    arrival = input->arrival;
  }
}

void replay(const ReplayArguments& arguments) {
  const OpenLog log = open_log_of(arguments);
  if (log.source) return replay_log(arguments, *log.source, log.topic);
  if (arguments.scene.empty())
    throw UsageError("--scene is missing: " + arguments.input + " does not have it, as " + log.why_not +
                     "; --help shows the usage");
  Simulation simulation = prepare_simulation(arguments);
  const ReplayInput input = open_input(arguments);
  ReplayRun run(arguments, input.topic);
  for (const auto* warnings : {&simulation.scene().warnings, &input.warnings})
    for (const std::string& warning : *warnings) run.progress.line("replay: " + warning);
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
