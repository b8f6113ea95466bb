// Stability of each contact model: a cube between fingertips, over mass, step, stiffness, number of contacts
// and restitution. See docs/speed_accuracy.md.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "mr_hand_interaction/response/contact_model.h"
#include "nodes/exit_status.h"
#include "support/stability_map.h"
#include "text/command_line.h"
#include "text/files.h"

namespace mrhi::testing {
namespace {

constexpr int kMasses = 11, kSteps = 9;

/// `count` values from `first` to `last` in geometric progression.
std::vector<double> geometric(double first, double last, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(first * std::pow(last / first, i / (count - 1.0)));
  return values;
}

/// Steps in whole nanoseconds, as the simulation counts them.
std::vector<double> steps() {
  std::vector<double> values = geometric(0.00025, 1.0 / 60.0, kSteps);
  for (double& step : values) step = 1e-9 * std::round(1e9 * step);
  return values;
}

StabilityGrid whole_grid() {
  return {geometric(0.001, 100.0, kMasses),
          steps(),
          {50.0, 300.0, 2000.0, 14000.0, 1e5},
          {1, 2, 5, 10, 20},
          {0.0, 0.5, 1.0}};
}

template <typename Value>
std::vector<Value> every_second(const std::vector<Value>& values) {
  std::vector<Value> kept;
  for (std::size_t i = 0; i < values.size(); i += 2) kept.push_back(values[i]);
  return kept;
}

/// Includes both ends of each range.
StabilityGrid coarse_grid() {
  const StabilityGrid whole = whole_grid();
  return {every_second(whole.masses), every_second(whole.steps), every_second(whole.stiffnesses),
          every_second(whole.contacts), every_second(whole.restitutions)};
}

void map_model(const char* name, ContactModelKind model, const StabilityGrid& grid, std::ostream& csv) {
  constexpr std::size_t kOutcomes = 4;
  int counts[kOutcomes] = {}, cells = 0;
  const auto start = std::chrono::steady_clock::now();
  grid.for_every_cell(model, [&](const StabilityCell& cell) {
    const StabilityResult result = StabilityRun(cell).play();
    (CsvRows(csv) << name << cell.mass << cell.step << cell.stiffness << cell.contacts << cell.restitution
                  << to_string(result.outcome) << result.largest_speed)
        .end_row();
    ++counts[static_cast<std::size_t>(result.outcome)];
    ++cells;
  });
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  std::printf("%-14s %d cells:", name, cells);
  for (std::size_t i = 0; i < kOutcomes; ++i)
    std::printf(" %5.1f %% %s", 100.0 * counts[i] / cells, to_string(static_cast<StabilityOutcome>(i)));
  std::printf(" (%.0f s)\n", elapsed.count());
  std::fflush(stdout);
}

constexpr char kUsage[] = R"(usage: stability_map [--quick] [--model NAME]... --output DIR
  --quick       540 cells of each model instead of 7425: every second value of each quantity
  --model NAME  this contact model alone; repeatable
  --output DIR  created if need be; stability_map.csv
docs/speed_accuracy.md says what a cell is.
)";

struct Arguments {
  bool quick = false, help = false;
  std::vector<std::string> models;
  std::string folder;

  bool wants(const std::string& model) const {
    return models.empty() || std::find(models.begin(), models.end(), model) != models.end();
  }
};

std::vector<std::string> model_names() {
  std::vector<std::string> names;
  for (const ContactModelEntry* model : contact_models()) names.emplace_back(model->name);
  return names;
}

Arguments arguments_of(const std::vector<std::string>& words) {
  Arguments arguments;
  CommandLine line;
  line.flag("--quick", arguments.quick)
      .each("--model", "NAME",
            [&](const OptionValue& given) { arguments.models.push_back(given.one_of(model_names())); })
      .once("--output", "DIR", arguments.folder);
  arguments.help = !line.read(words);
  if (!arguments.help && arguments.folder.empty()) throw UsageError("--output DIR is missing");
  return arguments;
}

int run(const Arguments& arguments) {
  if (arguments.help) {
    std::cout << kUsage;
    return 0;
  }
  std::filesystem::create_directories(arguments.folder);
  const std::string path = arguments.folder + "/stability_map.csv";
  std::ofstream csv(path);
  csv.precision(9);
  csv << "model,mass_kg,step_s,stiffness_n_m,contacts,restitution,outcome,largest_speed_m_s\n";
  const StabilityGrid grid = arguments.quick ? coarse_grid() : whole_grid();
  for (const ContactModelEntry* model : contact_models())
    if (arguments.wants(model->name)) map_model(model->name, {model->name}, grid, csv);
  csv.close();
  if (csv) return 0;
  throw std::runtime_error("cannot write " + path);
}

}  // namespace
}  // namespace mrhi::testing

int main(int argc, char** argv) {
  using namespace mrhi::testing;
  return mrhi::exit_status("stability_map", [&] { return run(arguments_of({argv + 1, argv + argc})); });
}
