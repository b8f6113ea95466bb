#include "run.h"

#include <unistd.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <filesystem>
#include <stdexcept>

#include "../text/files.h"
#include "../text/text.h"
#include "mr_hand_interaction/parameters.h"

namespace mrhi {
namespace {

Vector3 gravity_of(const Simulation& simulation) {
  return simulation.configuration().gravity.value_or(simulation.scene().gravity);
}

/// The outermost missing folder of a path; empty if all exist.
std::string first_missing(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::path missing;
  for (std::filesystem::path at = folder.lexically_normal();
       !at.empty() && !std::filesystem::exists(at, error); at = at.parent_path())
    missing = at;
  return missing.string();
}

using Members = std::vector<std::pair<std::string, Json>>;

Json json_of(const std::map<std::string, Material>& materials) {
  Members all;
  for (const auto& [name, material] : materials)
    all.emplace_back(name, Members{{"dynamic_friction", material.dynamic_friction},
                                   {"restitution", material.restitution},
                                   {"static_friction", material.static_friction},
                                   {"stiffness", material.stiffness}});
  return all;
}

Json json_of(const LiveRun& live) {
  return Members{{"version", live.version},
                 {"entries", live.entries},
                 {"missing", live.missing},
                 {"compared", live.compared},
                 {"same", live.same},
                 {"parts_at", live.diverges_at},
                 {"lost_by_queue", live.lost_by_queue},
                 {"changes", live.changes},
                 {"overridden", live.overridden}};
}

/// Folder of relative paths in the arguments; empty if it has been removed.
std::string working_folder() {
  std::error_code error;
  return std::filesystem::current_path(error).string();
}

/// Frames lost by the live simulation's queue, and rejected by this run for their stamps.
Json lost(const ReplaySummary& summary) {
  const auto count = [&](const char* reason) {
    const auto found = summary.rejected.find(reason);
    return found == summary.rejected.end() ? 0 : found->second;
  };
  return Members{{"by_queue", summary.live ? summary.live->lost_by_queue : 0},
                 {"by_order", count("stamp not increasing")},
                 {"by_stamp", count("stamp far ahead") + count("stamp out of range") +
                                  count(JointsInput::kStray) + count("first stamp of another clock")}};
}

}  // namespace

std::map<std::string, std::string> changed_parameters(const Configuration& configuration) {
  std::map<std::string, std::string> changed = parameter_texts(configuration);
  for (const auto& [name, text] : parameter_texts(Configuration()))
    if (changed.at(name) == text) changed.erase(name);
  return changed;
}

ReplayRun::ReplayRun(const ReplayArguments& arguments, const std::string& topic)
    : output_(arguments.output), created_folder_(first_missing(arguments.output)) {
  summary.input = arguments.input;
  summary.topic = topic;
  summary.arguments = arguments.repeatable;
  constexpr double kShownRate = 60.0;  // [Hz]
  std::optional<double> rate = arguments.marker_rate;
  if (!rate && (arguments.serve || !arguments.film.empty())) rate = kShownRate;
  if (rate || !arguments.marker_frames.empty())
    markers_ = marker_bag(output_ + "/markers.bag", rate, arguments.marker_frames);
}

void ReplayRun::begin(const Simulation& simulation, const std::string& scene) {
  const Configuration& configuration = simulation.configuration();
  if (!writer_) writer_ = std::make_unique<ResultWriter>(output_, simulation.scene());
  writer_->follow(simulation.scene());
  summary.scene = scene;
  summary.contact_model = configuration.contact_model.name;
  summary.version = MR_HAND_INTERACTION_VERSION;
  summary.gravity = gravity_of(simulation);
  for (const auto& [name, text] : changed_parameters(configuration)) summary.parameters[name] = text;
  for (const Body& body : simulation.scene().bodies) summary.materials[body.name] = body.material;
}

bool ReplayRun::frame(const HandFrame& hands, const std::optional<Nanoseconds>& expected,
                      const std::string& which, Simulation& simulation) {
  const Rejection rejection = simulation.begin(hands, expected);
  if (rejection != Rejection::none) {
    reject(to_string(rejection), which);
    return false;
  }
  while (summary.step_time.measure([&] { return simulation.step(); })) ++summary.steps;
  for (const std::string& what : simulation.end().not_finite) reject("not finite", what);
  ++summary.frames;
  if (last_stamp_ && hands.stamp > *last_stamp_) intervals_.push_back(to_seconds(hands.stamp - *last_stamp_));
  result(simulation);
  return true;
}

void ReplayRun::result(const Simulation& simulation) {
  const FrameResult& result = simulation.result();
  writer_->write(result, simulation.state(), gravity_of(simulation));
  if (markers_) markers_(simulation);
  summary.deepest_rendered = std::max(summary.deepest_rendered, simulation.deepest_rendered());
  count(result.events);
  if (result.restarted) ++summary.restarts;
  if (last_stamp_ && !result.restarted) summary.simulated_seconds += to_seconds(result.stamp - *last_stamp_);
  last_stamp_ = result.stamp;
  if (!first_stamp_) first_stamp_ = last_stamp_;
}

void ReplayRun::events(const std::vector<Event>& events, const Simulation& simulation) {
  writer_->write_events(events, simulation.result());
  count(events);
}

void ReplayRun::count(const std::vector<Event>& events) {
  for (const Event& event : events) ++summary.events[event_name(event.kind)];
}

void ReplayRun::reject(const std::string& reason, const std::string& detail) {
  if (++summary.rejected[reason] == 1) first_of_kind("frame rejected: " + reason + ": " + detail);
}

void ReplayRun::correct(const std::string& kind, const std::string& detail) {
  if (++summary.corrected[kind] == 1) first_of_kind(kind + ": " + detail);
}

void ReplayRun::first_of_kind(const std::string& text) {
  progress.line("replay: " + text + " (more of the kind are counted only)");
}

void ReplayRun::check_end() {
  std::vector<std::string> rejected;
  for (const auto& [reason, count] : summary.rejected)
    if (count > 1) rejected.push_back(std::to_string(count) + " " + reason);
  if (!rejected.empty())
    progress.line("replay: frames rejected in all: " + text::joined(rejected) +
                  "; used: " + std::to_string(summary.frames));
  if (summary.frames == 0)
    throw std::runtime_error(
        summary.input + ": no frame that can be used" +
        (summary.rejected.empty() ? "; it has none: record while a tracker publishes" : ""));
  writer_->flush();
  // Range of a tracker's median interval [s], and number of them that is needed to check it.
  constexpr double kMinInterval = 0.0003, kMaxInterval = 0.5;
  constexpr std::size_t kMinIntervals = 20;
  if (intervals_.size() < kMinIntervals) return;
  const auto middle = intervals_.begin() + static_cast<std::ptrdiff_t>(intervals_.size() / 2);
  std::nth_element(intervals_.begin(), middle, intervals_.end());
  const double interval = *middle;
  if (interval > kMinInterval && interval < kMaxInterval) return;
  progress.line("replay: " + summary.input + ": frames are " + text::number(interval) +
                " s apart; usual: 0.001 to 0.1 s. Stamps are in seconds; are these " +
                (interval > kMaxInterval ? "milliseconds or microseconds?" : "1000 times too small?"));
}

void ReplayRun::end(const Simulation& simulation, const std::string& error) {
  if (!error.empty() && summary.frames == 0 && !created_folder_.empty()) {
    writer_.reset();
    std::error_code ignored;
    std::filesystem::remove_all(created_folder_, ignored);
    return;
  }
  const Scene& scene = simulation.scene();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i)
    if (is_held(i, simulation.state())) summary.held_at_end.push_back(scene.bodies[i].name);
  summary.state_hash = hash(simulation.state());
  summary.error = error;
  write_file(output_ + "/summary.json", to_json(summary));
}

double ReplayRun::seconds() const {
  return last_stamp_ ? to_seconds(*last_stamp_ - *first_stamp_) : 0.0;
}

ProgressBar::ProgressBar() : is_terminal_(isatty(STDERR_FILENO) == 1) {}

ProgressBar::~ProgressBar() {
  wipe();
}

void ProgressBar::show(std::size_t position, std::size_t size) {
  constexpr int kWidth = 50;  // characters
  const int percent = size == 0 ? 100 : static_cast<int>(100 * position / size);
  if (!is_terminal_ || percent == percent_) return;
  percent_ = percent;
  const auto done = static_cast<std::size_t>(percent * kWidth / 100);
  const std::string bar = std::string(done, '#') + std::string(kWidth - done, '.');
  std::fprintf(stderr, "\r[%s] %3d %%", bar.c_str(), percent);
}

void ProgressBar::line(const std::string& text) {
  wipe();
  std::fprintf(stderr, "%s\n", text::one_line(text, 4000).c_str());
}

void ProgressBar::wipe() {
  if (percent_ >= 0) std::fputs("\r\033[K", stderr);
  percent_ = -1;
}

std::string to_json(const ReplaySummary& summary) {
  const DurationHistogram& times = summary.step_time;
  Members fields{
      {"scene", summary.scene},
      {"input", summary.input},
      {"topic", summary.topic},
      {"contact_model", summary.contact_model},
      {"version", summary.version},
      {"gravity", summary.gravity},
      {"parameters", summary.parameters},
      {"materials", json_of(summary.materials)},
      {"frames", summary.frames},
      {"simulated_seconds", summary.simulated_seconds},
      {"steps", summary.steps},
      {"step_time_us",
       Members{{"p50", times.quantile_us(0.5)}, {"p99", times.quantile_us(0.99)}, {"max", times.max_us()}}},
      {"deepest_rendered_penetration_m", summary.deepest_rendered},
      {"restarts", summary.restarts},
      {"rejected", summary.rejected},
      {"frames_lost", lost(summary)},
      {"corrected", summary.corrected},
      {"hands_left_out", summary.hands_left_out},
      {"events", summary.events},
      {"objects_held_at_end", summary.held_at_end},
      {"state_hash", text::format("%016" PRIx64, summary.state_hash)},
      {"not_known", summary.not_known}};
  if (summary.live) fields.emplace_back("live_run", json_of(*summary.live));
  fields.emplace_back("arguments", summary.arguments);
  fields.emplace_back("working_folder", working_folder());
  if (!summary.error.empty()) fields.emplace_back("error", summary.error);
  return Json(fields, "\n  ").text + "\n";
}

}  // namespace mrhi
