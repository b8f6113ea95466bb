// Benefit and cost of each contact refinement: turned off alone in the scene that needs it, and in scene (a)
// for the cost of a step; and what the paper's equations do as printed. Prints the tables of docs/contact.md.
#include <cstdio>
#include <string>
#include <vector>

#include "variant.h"

namespace mrhi::ablation {
namespace {

constexpr const char* kUsage =
    "usage: ablation | ablation --printed | ablation --steps none|REFINEMENT (scene (a) alone, for a "
    "profiler)\n";

std::string written(double value, const std::string& unit) {
  constexpr double kNothing = 1e-6;  // far below the precision of a printed value
  char text[32];
  std::snprintf(text, sizeof text, value < 1000.0 ? "%.3g" : "%.0f", value);
  return (value > 0.0 && value < kNothing ? "< 1e-6" : text) + (unit.empty() ? "" : " " + unit);
}

void print_benefits() {
  std::printf("| turned off | figure | on | off |\n|---|---|---|---|\n");
  for (const Measure& measure : measures()) {
    for (const Refinement& refinement : refinements()) {
      if (measure.refinement != refinement.name) continue;
      const std::string on = written(measure.of(Variant()), measure.unit);
      const std::string off = written(measure.of(refinement.without()), measure.unit);
      std::printf("| `%s` | %s | %s | %s |\n", refinement.name.c_str(), measure.what.c_str(), on.c_str(),
                  off.c_str());
      std::fflush(stdout);
    }
  }
}

void print_paper() {
  std::printf("| equations | figure | as we read them | as printed |\n|---|---|---|---|\n");
  for (const PrintedDifference& difference : printed_differences())
    std::printf("| %s | %s | %s | %s |\n", difference.equations.c_str(), difference.what.c_str(),
                written(difference.of(false), difference.unit).c_str(),
                written(difference.of(true), difference.unit).c_str());
}

void print_costs(const std::string& program) {
  std::vector<Variant> variants{Variant()};
  for (const Refinement& refinement : refinements()) variants.push_back(refinement.without());
  const std::vector<double> times = times_of_a_step(variants);
  const double count = instructions_of_a_step(program, "none");
  std::printf("\nA step of scene (a): %.0f instructions, %.0f ns.\n", count, times[0]);
  std::printf("\n| refinement | costs instructions | costs ns |\n|---|---|---|\n");
  for (std::size_t i = 0; i < refinements().size(); ++i) {
    const std::string& name = refinements()[i].name;
    const double cost = count - instructions_of_a_step(program, name);
    std::printf("| `%s` | %+.0f (%+.1f %%) | %+.0f |\n", name.c_str(), cost, 1e2 * cost / count,
                times[0] - times[i + 1]);
  }
}

int run(const std::vector<std::string>& arguments, const std::string& program) {
  if (arguments.empty()) {
    print_benefits();
    print_costs(program);
    return 0;
  }
  if (arguments.size() == 1 && arguments[0] == "--printed") return print_paper(), 0;
  if (arguments.size() == 2 && arguments[0] == "--steps") {
    if (arguments[1] == "none") return run_scene_a(Variant()), 0;
    for (const Refinement& refinement : refinements()) {
      if (refinement.name == arguments[1]) return run_scene_a(refinement.without()), 0;
    }
  }
  std::fputs(kUsage, stderr);
  return 2;
}

}  // namespace
}  // namespace mrhi::ablation

int main(int count, char** arguments) {
  return mrhi::ablation::run(std::vector<std::string>(arguments + 1, arguments + count), arguments[0]);
}
