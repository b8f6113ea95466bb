#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <set>
#include <stdexcept>

#include "../simulation/state_bytes.h"
#include "../text/csv.h"
#include "../text/text.h"
#include "dictionary.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/ros/package_paths.h"
#include "run.h"
#include "urdf_meshes.h"
#include "world.h"

namespace mrhi {
namespace {

/// What is given by hand, over what was recorded.
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
      for (const std::string& name : parameter_names()) {
        const std::string text = parameter_text(configuration, name);
        if (text != parameter_text(Configuration(), name)) take_parameter(name, text, world);
      }
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
      Body moving = simulation.scene().bodies[static_cast<std::size_t>(*find_body(simulation.scene(), name))];
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
    std::string file;
    try {
      file = find_scene_file(arguments_.scene, scene_folders());
    } catch (const SceneError& error) {
      throw UsageError(std::string("--scene: ") + error.what());
    }
    World given = world_of_file(file, Configuration());
    const auto same = [](const RecordedFile& a, const RecordedFile& b) {
      return a.name == b.name && a.bytes == b.bytes;
    };
    if (given.files.size() <= world.files.size() &&
        std::equal(given.files.begin(), given.files.end(), world.files.begin(), same))
      return;
    given.parameters = world.parameters;
    given.version = world.version;
    world = given;
    other_scene_ = true;
    differing_.push_back("--scene " + arguments_.scene);
  }

  void take_parameter(const std::string& name, const std::string& value, World& world) {
    Configuration configuration;
    try {
      set_parameter(configuration, name, value);
    } catch (const ParameterError& error) {
      throw UsageError(error.what());
    }
    const std::string text = parameter_text(configuration, name);
    std::string& recorded = world.parameters[name];
    if (recorded != text) differing_.push_back(name + "=" + text + " instead of " + recorded);
    recorded = text;
    fixed_.insert(name);
  }

  static BodyState& body_of(const char* option, const std::string& name, const Scene& scene,
                            SimulationState& state) {
    const auto body = find_body(scene, name);
    if (!body || scene.bodies[static_cast<std::size_t>(*body)].fixed)
      throw UsageError(std::string(option) + ": no free object '" + name + "' as the recording begins");
    return state.bodies[static_cast<std::size_t>(*body)];
  }

  const ReplayArguments& arguments_;
  std::set<std::string> fixed_;
  bool other_scene_ = false;
  std::vector<std::string> differing_;
};

class LogRun {
 public:
  LogRun(const ReplayArguments& arguments, const std::string& topic)
      : arguments_(arguments), overrides_(arguments), watcher_(marker_watcher(arguments)) {
    summary_.input = arguments.input;
    summary_.topic = topic;
    summary_.arguments = arguments.repeatable;
    summary_.live.emplace();
  }

  void all(LogSource& log) {
    while (const std::optional<LogEntry> entry = log.next()) {
      progress_.show(log.position(), log.size());
      take(*entry);
    }
    if (!simulation_) throw std::runtime_error(arguments_.input + ": the recording has no beginning");
    if (summary_.frames == 0) throw std::runtime_error(arguments_.input + ": no frame that can be used");
    writer_->flush();
  }

  /// Also of a run that ended early.
  void end(const std::string& error) {
    summary_.error = error;
    if (!simulation_) return;
    tell_end(simulation(), summary_);
    write_summary(arguments_.output, summary_);
    const LiveRun& live = *summary_.live;
    if (live.parts_at)
      progress_.line("replay: parts from the live run at " + text::number(*live.parts_at) + " s");
    for (const std::string& what : live.overridden) progress_.line("replay: not as recorded: " + what);
    for (const std::string& what : summary_.not_known) progress_.line("replay: not known: " + what);
    if (live.missing > 0)
      progress_.line("replay: the recording has lost " + std::to_string(live.missing) + " entries");
  }

 private:
  Simulation& simulation() { return simulation_->simulation(); }

  void take(const LogEntry& entry) {
    if (entry.kind == LogEntry::Kind::begin) return begin(entry);
    if (!simulation_) return;  // of who was there before it began
    if (entry.run != run_) {
      broken_ = true;  // until it begins
      return;
    }
    if (entry.sequence <= sequence_) return;
    if (entry.sequence != sequence_ + 1) {
      summary_.live->missing += entry.sequence - sequence_ - 1;
      broken_ = true;
    }
    sequence_ = entry.sequence;
    summary_.live->lost_by_queue = entry.lost - lost_before_;
    ++summary_.live->entries;
    if (entry.kind == LogEntry::Kind::frame) frame(entry);
    if (entry.kind == LogEntry::Kind::without_hands) without_hands(entry);
    if (entry.kind == LogEntry::Kind::change) change(entry);
    compare(entry);
  }

  void begin(const LogEntry& entry) {
    const bool known = simulation_ && entry.run == run_;
    if (known && entry.sequence > sequence_) summary_.live->missing += entry.sequence - sequence_;
    if (known && !broken_ && entry.sequence <= sequence_) return;
    if (!known) lost_before_ = entry.lost;
    run_ = entry.run;
    sequence_ = entry.sequence;
    broken_ = false;
    World world = world_from_yaml(entry.text, entry.files);
    overrides_.apply(world);
    const Configuration configuration = configuration_of(world, summary_.not_known);
    simulation_ =
        std::make_unique<LiveSimulation>(scene_of(world, configuration, scratch_.path()), configuration);
    if (!overrides_.other_scene()) take_state(entry);
    overrides_.place(simulation());
    tell_begin(world);
    compare(entry);
  }

  void take_state(const LogEntry& entry) {
    try {
      simulation().set_state(state_from_bytes(entry.state, simulation().scene()));
    } catch (const std::invalid_argument& error) {
      summary_.not_known.push_back(std::string("where things were as the recording began: ") + error.what());
    }
  }

  void tell_begin(const World& world) {
    if (!writer_) writer_ = std::make_unique<ResultWriter>(arguments_.output, simulation().scene());
    if (!hashes_)
      hashes_ = std::make_unique<CsvFile>(arguments_.output + "/hashes.csv", table_of("hashes.csv").header());
    writer_->follow(simulation().scene());
    summary_.scene = world.scene;
    summary_.live->version = world.version;
    summary_.live->overridden = overrides_.differing();
    tell_setting(simulation(), summary_);
    if (world.version != summary_.version)
      summary_.not_known.push_back("what version " + world.version + " did otherwise than this one, " +
                                   summary_.version);
  }

  void frame(const LogEntry& entry) {
    if (!entry.hands) return reject("unusable hand", entry.text, progress_, summary_);
    const Rejection rejection = simulation().begin(*entry.hands, entry.expected);
    if (rejection != Rejection::none) {
      return reject(to_string(rejection), "entry " + std::to_string(entry.sequence), progress_, summary_);
    }
    while (timed_step(simulation(), summary_)) {
    }
    const FrameResult& result = simulation().end();
    for (const std::string& what : result.not_finite) reject("not finite", what, progress_, summary_);
    ++summary_.frames;
    note_result();
  }

  void without_hands(const LogEntry& entry) {
    if (simulation().advance_without_hands(entry.time)) note_result();
  }

  void note_result() {
    writer_->write(simulation().result(), simulation().state(), gravity_of(simulation()));
    if (watcher_) watcher_(simulation());
    add_result(simulation(), last_stamp_, summary_);
    last_stamp_ = simulation().result().stamp;
    if (!first_stamp_) first_stamp_ = last_stamp_;
  }

  void change(const LogEntry& entry) {
    Change change = change_from_yaml(entry.text, entry.files);
    char time[32];
    std::snprintf(time, sizeof time, "%.3f s: ", seconds());
    summary_.live->changes.push_back(time + text::one_line(to_text(change), 200));
    if (auto* spawn = std::get_if<Spawn>(&change))
      spawn->request.urdf = with_meshes_in(scratch_.path(), spawn->request.urdf, entry.files);
    if (auto* set = std::get_if<SetParameters>(&change)) drop_overridden(*set);
    try {
      make(change, *simulation_);
    } catch (const std::exception& error) {
      reject("change", error.what(), progress_, summary_);
    }
    writer_->follow(simulation().scene());
  }

  void drop_overridden(SetParameters& set) const {
    set.values.erase(std::remove_if(set.values.begin(), set.values.end(),
                                    [&](const auto& value) { return overrides_.holds(value.first); }),
                     set.values.end());
  }

  double seconds() const { return last_stamp_ ? to_seconds(*last_stamp_ - *first_stamp_) : 0.0; }

  void compare(const LogEntry& entry) {
    const std::uint64_t here = hash(simulation().state());
    char text[20];
    std::snprintf(text, sizeof text, "%016" PRIx64, here);
    *hashes_ << std::to_string(entry.sequence) << std::to_string(entry.stamp) << std::string(text);
    hashes_->end_row();
    if (broken_ || !overrides_.differing().empty()) return;
    LiveRun& live = *summary_.live;
    ++live.compared;
    if (here == entry.state_hash) ++live.same;
    if (here != entry.state_hash && !live.parts_at) live.parts_at = seconds();
  }

  const ReplayArguments& arguments_;
  Overrides overrides_;
  FrameWatcher watcher_;
  ScratchFolder scratch_;
  ProgressBar progress_;
  ReplaySummary summary_;
  std::unique_ptr<LiveSimulation> simulation_;
  std::unique_ptr<ResultWriter> writer_;
  std::unique_ptr<CsvFile> hashes_;
  std::uint64_t run_ = 0, sequence_ = 0, lost_before_ = 0;
  bool broken_ = false;  ///< entries are missing, so that nothing is as it was
  std::optional<Nanoseconds> first_stamp_, last_stamp_;
};

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

}  // namespace mrhi
