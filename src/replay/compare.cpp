#include "mr_hand_interaction/replay/compare.h"

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <map>
#include <optional>
#include <set>

#include "../text/text.h"
#include "csv_columns.h"
#include "mr_hand_interaction/replay/recording_csv.h"

namespace mrhi {
namespace {

struct Row {
  double time;
  Vector3 place;
  std::string cells;  // as they were written, for what counts as the same
};

using Ways = std::map<std::string, std::vector<Row>>;

Ways read_ways(const std::string& folder) {
  const std::string file = folder + "/objects.csv";
  std::ifstream in(file);
  std::string line;
  if (!std::getline(in, line)) throw RecordingError(file + ": cannot be read, or is empty");
  CsvColumns columns(file, line);
  Ways ways;
  for (std::size_t number = 2; std::getline(in, line); ++number) {
    columns.take(line, number);
    const Vector3 place(columns.required("px"), columns.required("py"), columns.required("pz"));
    ways[text::split(line).at(1)].push_back({columns.required("time"), place, line});
  }
  return ways;
}

/// Compared frame by frame, up to the first one that one of them alone has.
std::optional<Parting> parting(const std::string& object, const std::vector<Row>& first,
                               const std::vector<Row>& second) {
  std::optional<Parting> result;
  const std::size_t both = std::min(first.size(), second.size());
  for (std::size_t i = 0; i < both; ++i) {
    const Row &a = first[i], &b = second[i];
    if (a.time != b.time)
      return result ? result
                    : Parting{object, std::min(a.time, b.time), a.place, 0.0, 0.0, "a frame of one alone"};
    const double distance = (a.place - b.place).norm();
    if (!result && a.cells != b.cells) result = Parting{object, a.time, a.place, distance, distance, ""};
    if (result) result->farthest = std::max(result->farthest, distance);
  }
  if (result || first.size() == second.size()) return result;
  const Row& more = (first.size() > second.size() ? first : second)[both];
  return Parting{object, more.time, more.place, 0.0, 0.0, "one run ends"};
}

std::string line_of(const Parting& parting) {
  char text[200];
  std::snprintf(text, sizeof text, ": parts at %.6g s near (%.4g, %.4g, %.4g) m", parting.time,
                parting.place.x(), parting.place.y(), parting.place.z());
  std::string line = parting.object + text;
  if (!parting.why.empty()) return line + ": " + parting.why + "\n";
  std::snprintf(text, sizeof text, " by %.3g m, at most by %.3g m\n", parting.distance, parting.farthest);
  return line + text;
}

}  // namespace

Comparison compare_runs(const std::string& first, const std::string& second) {
  const Ways a = read_ways(first), b = read_ways(second);
  std::set<std::string> names;
  for (const Ways* ways : {&a, &b})
    for (const auto& way : *ways) names.insert(way.first);
  Comparison comparison;
  comparison.objects = names.size();
  for (const std::string& name : names) {
    const auto in_a = a.find(name), in_b = b.find(name);
    if (in_a == a.end() || in_b == b.end()) {
      const Row& row = (in_a == a.end() ? in_b : in_a)->second.front();
      comparison.partings.push_back({name, row.time, row.place, 0.0, 0.0, "an object of one alone"});
    } else if (const auto found = parting(name, in_a->second, in_b->second)) {
      comparison.partings.push_back(*found);
    }
  }
  std::stable_sort(comparison.partings.begin(), comparison.partings.end(),
                   [](const Parting& x, const Parting& y) { return x.time < y.time; });
  return comparison;
}

std::string to_text(const Comparison& comparison) {
  std::string text;
  for (const Parting& parting : comparison.partings) text += line_of(parting);
  const std::size_t same = comparison.objects - comparison.partings.size();
  return text + std::to_string(same) + " of " + std::to_string(comparison.objects) +
         " objects the same to the last digit\n";
}

}  // namespace mrhi
