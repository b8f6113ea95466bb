#include "run.h"

#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "../text/file_text.h"
#include "mr_hand_interaction/parameters.h"

namespace mrhi {

bool timed_step(Simulation& simulation, ReplaySummary& summary) {
  const auto begin = std::chrono::steady_clock::now();
  if (!simulation.step()) return false;
  const auto time = std::chrono::steady_clock::now() - begin;
  summary.step_time.add(std::chrono::duration_cast<std::chrono::nanoseconds>(time).count());
  ++summary.steps;
  return true;
}

Vector3 gravity_of(const Simulation& simulation) {
  return simulation.configuration().gravity.value_or(simulation.scene().gravity);
}

void add_result(const Simulation& simulation, const std::optional<Nanoseconds>& since,
                ReplaySummary& summary) {
  const FrameResult& result = simulation.result();
  summary.deepest_rendered = std::max(summary.deepest_rendered, simulation.deepest_rendered());
  for (const Event& event : result.events) ++summary.events[event_name(event.kind)];
  if (result.restarted) ++summary.restarts;
  if (since && !result.restarted) summary.simulated_seconds += to_seconds(result.stamp - *since);
}

void reject(const std::string& reason, const std::string& detail, ProgressBar& progress,
            ReplaySummary& summary) {
  if (++summary.rejected[reason] > 1) return;
  progress.line("replay: frame rejected: " + reason + ": " + detail + " (more of the kind are counted only)");
}

void tell_setting(const Simulation& simulation, ReplaySummary& summary) {
  const Configuration& configuration = simulation.configuration();
  summary.contact_model = configuration.contact_model.name;
  summary.version = MR_HAND_INTERACTION_VERSION;
  summary.gravity = gravity_of(simulation);
  for (const std::string& name : parameter_names()) {
    const std::string text = parameter_text(configuration, name);
    if (text != parameter_text(Configuration(), name)) summary.parameters[name] = text;
  }
  for (const Body& body : simulation.scene().bodies) summary.materials[body.name] = body.material;
}

void tell_end(const Simulation& simulation, ReplaySummary& summary) {
  const Scene& scene = simulation.scene();
  for (std::size_t i = 0; i < scene.bodies.size(); ++i) {
    if (is_held(i, simulation.state())) summary.held_at_end.push_back(scene.bodies[i].name);
  }
  summary.state_hash = hash(simulation.state());
}

namespace {

void write_text(const std::string& path, const std::string& text) {
  std::ofstream file = file_to_write(path);
  file << text << std::flush;
  if (!file) throw std::runtime_error("cannot write " + path);
}

std::string counted(std::uint64_t count, const char* what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

std::string seconds_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%.2f s", seconds);
  return text;
}

std::string rejected_text(const ReplaySummary& summary) {
  std::string text = "Frames lost: " + std::to_string(summary.live ? summary.live->lost_by_queue : 0) +
                     " by a queue on the way to the simulation";
  for (const auto& [reason, count] : summary.rejected) text += ", " + std::to_string(count) + ": " + reason;
  return text + ".";
}

std::string live_text(const LiveRun& live) {
  if (!live.overridden.empty()) {
    std::string text = "Not as recorded: ";
    for (const std::string& what : live.overridden) text += what + "; ";
    return text + "the rest is.";
  }
  if (live.parts_at) return "This run parts from the live one at " + seconds_text(*live.parts_at) + ".";
  return "The live run to the bit: " + std::to_string(live.same) + " of " +
         counted(live.compared, "recorded state") + " the same.";
}

std::vector<std::string> facts_of(const ReplaySummary& summary) {
  char gravity[64];
  std::snprintf(gravity, sizeof gravity, "[%g, %g, %g] m/s^2", summary.gravity.x(), summary.gravity.y(),
                summary.gravity.z());
  std::vector<std::string> facts{"Scene '" + summary.scene + "', gravity " + gravity + ", contact model " +
                                     summary.contact_model + ", version " + summary.version + "; " +
                                     counted(summary.frames, "frame") + ", " +
                                     seconds_text(summary.simulated_seconds) + ".",
                                 rejected_text(summary)};
  if (summary.live) facts.push_back(live_text(*summary.live));
  std::string other;
  for (const auto& [name, value] : summary.parameters)
    other += (other.empty() ? "" : ", ") + name + ": " + value;
  if (!other.empty()) facts.push_back("Parameters that are not the default: " + other + ".");
  for (const std::string& what : summary.not_known) facts.push_back("Not known: " + what + ".");
  if (summary.live)
    for (const std::string& change : summary.live->changes) facts.push_back("Changed at " + change + ".");
  return facts;
}

}  // namespace

void write_summary(const std::string& folder, const ReplaySummary& summary) {
  write_text(folder + "/summary.json", to_json(summary));
}

FrameWatcher Explaining::watcher() {
  if (!arguments_.explain && !arguments_.demonstration) return {};
  return [this](const Simulation& simulation) {
    if (arguments_.explain) {
      explainer_.watch(simulation);
      markers_.watch(simulation);
    }
    if (arguments_.demonstration) demonstration_.watch(simulation);
  };
}

void Explaining::write(const ReplaySummary& summary) {
  if (arguments_.demonstration) {
    const double rate = *arguments_.demonstration;
    const Demonstration even = rate > 0.0 ? demonstration_.at_rate(rate) : demonstration_;
    write_demonstration_csv(even, arguments_.output + "/demonstration.csv");
    write_demonstration_bag(even, arguments_.output + "/demonstration.bag");
  }
  if (!arguments_.explain) return;
  Explanation explanation = explainer_.explain(arguments_.input);
  explanation.facts = facts_of(summary);
  markers_.write(explanation.moments, arguments_.output + "/moments.bag");
  write_text(arguments_.output + "/explain.json", to_json(explanation));
  write_text(arguments_.output + "/explain.html", to_html(explanation));
}

ScratchFolder::ScratchFolder() {
  path_ = (std::filesystem::temp_directory_path() / "replay_XXXXXX").string();
  if (mkdtemp(&path_[0]) == nullptr) throw std::runtime_error("cannot make a folder " + path_);
}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace mrhi
