// Where each contact model stays stable: a cube between fingertips, over mass, step, stiffness, number of
// contacts and restitution. See docs/stability.md.

#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include "mr_hand_interaction/response/contact_model.h"
#include "support/stability_map.h"

namespace mrhi::testing {
namespace {

constexpr int kMasses = 11, kSteps = 9;

/// `count` values from `first` to `last`, each the same multiple of the one before.
std::vector<double> geometric(double first, double last, int count) {
  std::vector<double> values;
  for (int i = 0; i < count; ++i) values.push_back(first * std::pow(last / first, i / (count - 1.0)));
  return values;
}

/// The step in whole nanoseconds, as the simulation counts it.
std::vector<double> steps() {
  std::vector<double> values = geometric(0.00025, 1.0 / 60.0, kSteps);
  for (double& step : values) step = 1e-9 * std::round(1e9 * step);
  return values;
}

StabilityGrid grid() {
  return {geometric(0.001, 100.0, kMasses),
          steps(),
          {50.0, 300.0, 2000.0, 14000.0, 1e5},
          {1, 2, 5, 10, 20},
          {0.0, 0.5, 1.0}};
}

void map_model(const char* name, ContactModelKind model, std::ostream& csv) {
  constexpr std::size_t kOutcomes = 4;
  int counts[kOutcomes] = {}, cells = 0;
  const auto start = std::chrono::steady_clock::now();
  grid().for_every_cell(model, [&](const StabilityCell& cell) {
    const StabilityResult result = StabilityRun(cell).play();
    csv << name << ',' << cell.mass << ',' << cell.step << ',' << cell.stiffness << ',' << cell.contacts
        << ',' << cell.restitution << ',' << to_string(result.outcome) << ',' << result.largest_speed << '\n';
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

int run(const std::string& folder) {
  const std::string path = folder + "/stability_map.csv";
  std::ofstream csv(path);
  csv.precision(9);
  csv << "model,mass_kg,step_s,stiffness_n_m,contacts,restitution,outcome,largest_speed_m_s\n";
  for (const ContactModelEntry* model : contact_models()) {
    if (csv) map_model(model->name, {model->name}, csv);
  }
  csv.close();
  if (csv) return 0;
  std::cerr << "stability_map: cannot write " << path << '\n';
  return 1;
}

}  // namespace
}  // namespace mrhi::testing

int main(int argc, char** argv) {
  if (argc != 3 || std::string(argv[1]) != "--output") {
    std::cerr << "usage: stability_map --output DIR\n";
    return 2;
  }
  return mrhi::testing::run(argv[2]);
}
