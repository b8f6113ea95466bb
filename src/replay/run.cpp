#include "run.h"

#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <memory>
#include <stdexcept>

#include "../text/file_text.h"
#include "marker_bag.h"
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

void write_summary(const std::string& folder, const ReplaySummary& summary) {
  const std::string path = folder + "/summary.json";
  std::ofstream file = file_to_write(path);
  file << to_json(summary) << std::flush;
  if (!file) throw std::runtime_error("cannot write " + path);
}

FrameWatcher marker_watcher(const ReplayArguments& arguments) {
  if (arguments.markers.empty()) return {};
  const auto bag = std::make_shared<MarkerBag>(arguments.output + "/markers.bag", arguments.markers);
  return [bag](const Simulation& simulation) { bag->watch(simulation); };
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
