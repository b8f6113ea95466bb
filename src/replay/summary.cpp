#include "summary.h"

#include <cinttypes>
#include <cstdio>
#include <filesystem>

#include "json_text.h"

namespace mrhi {
namespace {

using json::number;
using json::quoted;

/// With what `as_json` makes of each value.
template <typename Value, typename AsJson>
std::string object(const std::map<std::string, Value>& members, AsJson as_json) {
  std::string text;
  for (const auto& [name, value] : members)
    text += (text.empty() ? "" : ", ") + quoted(name) + ": " + as_json(value);
  return "{" + text + "}";
}

std::string object(const std::map<std::string, std::uint64_t>& counts) {
  return object(counts, [](std::uint64_t count) { return std::to_string(count); });
}

std::string material(const Material& material) {
  const std::map<std::string, double> fields{{"restitution", material.restitution},
                                             {"static_friction", material.static_friction},
                                             {"dynamic_friction", material.dynamic_friction},
                                             {"stiffness", material.stiffness}};
  return object(fields, number);
}

std::string list(const Vector3& vector) {
  return "[" + number(vector.x()) + ", " + number(vector.y()) + ", " + number(vector.z()) + "]";
}

std::string list(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + quoted(name);
  return "[" + text + "]";
}

std::string step_times(const DurationHistogram& times) {
  return "{\"p50\": " + number(times.quantile_us(0.5)) + ", \"p99\": " + number(times.quantile_us(0.99)) +
         ", \"max\": " + number(times.max_us()) + "}";
}

std::string live_run(const LiveRun& live) {
  return "{\"version\": " + quoted(live.version) + ", \"entries\": " + std::to_string(live.entries) +
         ", \"missing\": " + std::to_string(live.missing) +
         ", \"compared\": " + std::to_string(live.compared) + ", \"same\": " + std::to_string(live.same) +
         ", \"parts_at\": " + (live.parts_at ? number(*live.parts_at) : "null") +
         ", \"lost_by_queue\": " + std::to_string(live.lost_by_queue) +
         ", \"changes\": " + list(live.changes) + ", \"overridden\": " + list(live.overridden) + "}";
}

/// To which relative paths in the arguments are; empty if it is gone.
std::string working_folder() {
  std::error_code error;
  return std::filesystem::current_path(error).string();
}

/// By a queue on the way to the live simulation; and by stamps, which this run has judged itself.
std::string lost(const ReplaySummary& summary) {
  const auto count = [&](const char* reason) {
    const auto found = summary.rejected.find(reason);
    return found == summary.rejected.end() ? 0 : found->second;
  };
  return object({{"by_queue", summary.live ? summary.live->lost_by_queue : 0},
                 {"by_order", count("stamp not increasing")},
                 {"by_stamp", count("stamp far ahead") + count("stamp out of range") +
                                  count("first stamp of another clock")}});
}

}  // namespace

std::string to_json(const ReplaySummary& summary) {
  char hash[17];
  std::snprintf(hash, sizeof hash, "%016" PRIx64, summary.state_hash);
  std::vector<std::pair<std::string, std::string>> fields{
      {"scene", quoted(summary.scene)},
      {"input", quoted(summary.input)},
      {"topic", quoted(summary.topic)},
      {"contact_model", quoted(summary.contact_model)},
      {"version", quoted(summary.version)},
      {"gravity", list(summary.gravity)},
      {"parameters", object(summary.parameters, quoted)},
      {"materials", object(summary.materials, material)},
      {"frames", std::to_string(summary.frames)},
      {"simulated_seconds", number(summary.simulated_seconds)},
      {"steps", std::to_string(summary.steps)},
      {"step_time_us", step_times(summary.step_time)},
      {"deepest_rendered_penetration_m", number(summary.deepest_rendered)},
      {"restarts", std::to_string(summary.restarts)},
      {"rejected", object(summary.rejected)},
      {"frames_lost", lost(summary)},
      {"corrected", object(summary.corrected)},
      {"hands_left_out", std::to_string(summary.hands_left_out)},
      {"events", object(summary.events)},
      {"objects_held_at_end", list(summary.held_at_end)},
      {"state_hash", quoted(hash)},
      {"not_known", list(summary.not_known)}};
  if (summary.live) fields.emplace_back("live_run", live_run(*summary.live));
  fields.emplace_back("arguments", list(summary.arguments));
  fields.emplace_back("working_folder", quoted(working_folder()));
  if (!summary.error.empty()) fields.emplace_back("error", quoted(summary.error));
  std::string text = "{";
  for (const auto& [name, value] : fields)
    text += (text == "{" ? "\n  " : ",\n  ") + quoted(name) + ": " + value;
  return text + "\n}\n";
}

}  // namespace mrhi
