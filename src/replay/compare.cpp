#include "mr_hand_interaction/replay/compare.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include "../text/file_text.h"
#include "../text/text.h"
#include "csv_columns.h"
#include "mr_hand_interaction/replay/recording_csv.h"

namespace mrhi {
namespace {

struct Row {
  double time;
  Pose pose;
  std::string cells;  // as they were written, for what counts as the same
};

using Ways = std::map<std::string, std::vector<Row>>;

Ways read_ways(const std::string& folder) try {
  const std::string file = folder + "/objects.csv";
  FileLines lines(file);
  std::string line;
  if (!lines.next(line)) throw RecordingError(file + ": is empty; allowed: what replay has written");
  CsvColumns columns(file, line);
  Ways ways;
  while (lines.next(line)) {
    columns.take(line, lines.number());
    const auto cell = [&](const char* name) { return columns.required(name); };
    const Pose pose{{cell("px"), cell("py"), cell("pz")}, {cell("qw"), cell("qx"), cell("qy"), cell("qz")}};
    ways[text::split(line).at(1)].push_back({cell("time"), pose, line});
  }
  return ways;
} catch (const FileError& error) {
  throw RecordingError(error.what());
}

/// Both ways of an object, and what counts as apart.
struct Pair {
  const std::string& object;
  const std::vector<Row>&first, &second;
  Tolerance tolerance;

  bool exact() const { return tolerance.distance <= 0.0 && tolerance.angle <= 0.0; }
  double distance(std::size_t i) const { return (first[i].pose.position - second[i].pose.position).norm(); }
  double angle(std::size_t i) const {
    return first[i].pose.orientation.angularDistance(second[i].pose.orientation);
  }
  bool differs(std::size_t i) const { return first[i].cells != second[i].cells; }
  bool apart(std::size_t i) const {
    if (!differs(i)) return false;
    // Not "greater than": what is no number is apart.
    return exact() || !(distance(i) <= tolerance.distance && angle(i) <= tolerance.angle);
  }
  /// Frames up to the first one that one of them alone has.
  std::size_t common() const {
    const std::size_t both = std::min(first.size(), second.size());
    std::size_t i = 0;
    while (i < both && first[i].time == second[i].time) ++i;
    return i;
  }
};

Parting told_from(const Pair& pair, std::size_t from) {
  Parting parting;
  parting.object = pair.object;
  parting.time = pair.first[from].time;
  parting.place = pair.first[from].pose.position;
  parting.distance = pair.distance(from);
  parting.angle = pair.angle(from);
  for (std::size_t i = from; i < pair.common(); ++i) {
    parting.farthest = std::max(parting.farthest, pair.distance(i));
    parting.most_turned = std::max(parting.most_turned, pair.angle(i));
  }
  return parting;
}

template <class Test>
std::optional<Parting> first_that(const Pair& pair, Test test) {
  for (std::size_t i = 0; i < pair.common(); ++i)
    if (test(i)) return told_from(pair, i);
  return {};
}

Parting alone(const std::string& object, const Row& row, const std::string& why) {
  Parting parting;
  parting.object = object;
  parting.time = row.time;
  parting.place = row.pose.position;
  parting.why = why;
  return parting;
}

std::optional<Parting> parting_of(const Pair& pair) {
  if (const auto apart = first_that(pair, [&](std::size_t i) { return pair.apart(i); })) return apart;
  const std::size_t i = pair.common();
  const bool first_ends = i == pair.first.size(), second_ends = i == pair.second.size();
  if (first_ends && second_ends) return {};
  if (first_ends || second_ends)
    return alone(pair.object, (first_ends ? pair.second : pair.first)[i], "one run ends");
  return alone(pair.object, (pair.first[i].time < pair.second[i].time ? pair.first : pair.second)[i],
               "a frame of one alone");
}

/// As `replay` writes it into summary.json; empty where there is none.
std::string end_hash(const std::string& folder) {
  constexpr std::size_t kMostBytes = std::size_t{64} << 20;
  std::istringstream in(file_text(folder + "/summary.json", kMostBytes).value_or(""));
  for (std::string line; std::getline(in, line);) {
    const std::string key = "\"state_hash\": \"";
    const std::size_t at = line.find(key);
    if (at != std::string::npos) return line.substr(at + key.size(), 16);
  }
  return {};
}

std::string apart_text(double distance, double angle) {
  char text[80];
  std::snprintf(text, sizeof text, "%.3g m and %.3g rad", distance, angle);
  return text;
}

std::string line_of(const Parting& parting, const char* what) {
  char text[200];
  std::snprintf(text, sizeof text, ": %s %.6g s near (%.4g, %.4g, %.4g) m", what, parting.time,
                parting.place.x(), parting.place.y(), parting.place.z());
  const std::string line = parting.object + text;
  if (!parting.why.empty()) return line + ": " + parting.why + "\n";
  return line + " by " + apart_text(parting.distance, parting.angle) + ", at most by " +
         apart_text(parting.farthest, parting.most_turned) + "\n";
}

std::string bits_text(const Comparison& comparison) {
  const bool same_ways = comparison.partings.empty() && comparison.near_misses.empty();
  const std::string ways = same_ways ? "objects: the same bits in every frame" : "objects: not the same bits";
  if (!comparison.same_end) return ways + "; the state at the end: not told by both runs\n";
  return ways + "; the state at the end: " + (*comparison.same_end ? "" : "not ") + "the same bits\n";
}

}  // namespace

Comparison compare_runs(const std::string& first, const std::string& second, const Tolerance& tolerance) {
  const Ways a = read_ways(first), b = read_ways(second);
  std::set<std::string> names;
  for (const Ways* ways : {&a, &b})
    for (const auto& way : *ways) names.insert(way.first);
  Comparison comparison;
  comparison.tolerance = tolerance;
  comparison.objects = names.size();
  for (const std::string& name : names) {
    const auto in_a = a.find(name), in_b = b.find(name);
    if (in_a == a.end() || in_b == b.end()) {
      const Row& row = (in_a == a.end() ? in_b : in_a)->second.front();
      comparison.partings.push_back(alone(name, row, "an object of one alone"));
      continue;
    }
    const Pair pair{name, in_a->second, in_b->second, tolerance};
    if (const auto apart = parting_of(pair))
      comparison.partings.push_back(*apart);
    else if (const auto near = first_that(pair, [&](std::size_t i) { return pair.differs(i); }))
      comparison.near_misses.push_back(*near);
  }
  for (auto* told : {&comparison.partings, &comparison.near_misses})
    std::stable_sort(told->begin(), told->end(),
                     [](const Parting& x, const Parting& y) { return x.time < y.time; });
  const std::string hash_a = end_hash(first), hash_b = end_hash(second);
  if (!hash_a.empty() && !hash_b.empty()) comparison.same_end = hash_a == hash_b;
  return comparison;
}

std::string to_text(const Comparison& comparison) {
  std::string text;
  for (const Parting& parting : comparison.partings) text += line_of(parting, "parts at");
  for (const Parting& parting : comparison.near_misses)
    text += line_of(parting, "does not part, but differs from");
  const std::size_t together = comparison.objects - comparison.partings.size();
  const Tolerance& tolerance = comparison.tolerance;
  const std::string within =
      tolerance.distance <= 0.0 && tolerance.angle <= 0.0
          ? "the same to the last digit"
          : "within " + apart_text(tolerance.distance, tolerance.angle) + " in every frame";
  return text + std::to_string(together) + " of " + std::to_string(comparison.objects) + " objects " +
         within + "\n" + bits_text(comparison);
}

}  // namespace mrhi
