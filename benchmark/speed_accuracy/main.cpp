#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <map>
#include <optional>

#include "configured.h"
#include "contender.h"
#include "nodes/exit_status.h"
#include "text/command_line.h"

namespace mrhi::benchmark {
namespace {

const std::vector<double> kSteps{0.00025, 0.0005, 0.001, 0.002, 0.004, 0.008333333, 0.016666667};
const std::vector<double> kQuickSteps{0.001, 0.008333333};
constexpr double kQuickBudget = 1.0;  // of a contender [s]

struct Arguments {
  bool quick = false;
  std::vector<std::string> scenes;   ///< names, or names of groups; empty: all
  std::vector<std::string> engines;  ///< empty: all
  std::string output;                ///< folder, created if missing
};

struct Plan {
  std::vector<ScenePlan> scenes;
  std::vector<std::pair<EngineModule, std::vector<std::string>>> engines;  // with settings
  bool quick = false;
};

bool chosen(const std::vector<std::string>& names, const std::string& name) {
  return names.empty() || std::find(names.begin(), names.end(), name) != names.end();
}

std::vector<std::string> known_scenes(const std::vector<ScenePlan>& scenes) {
  std::vector<std::string> names;
  for (const ScenePlan& scene : scenes) names.push_back(scene.name);
  for (const ScenePlan& scene : scenes)
    if (!chosen(names, scene.group)) names.push_back(scene.group);
  return names;
}

/// Empty for --help. Throws UsageError.
std::optional<Arguments> read_arguments(const std::vector<std::string>& words) {
  std::vector<std::string> engines;
  for (const EngineModule& module : engine_modules()) engines.push_back(module.name);
  Arguments a;
  CommandLine line;
  line.flag("--quick", a.quick).once("--output", "DIR", a.output);
  line.each("--scene", "NAME",
            [&](const OptionValue& given) { a.scenes.push_back(given.one_of(known_scenes(all_scenes()))); });
  line.each("--engine", "NAME",
            [&](const OptionValue& given) { a.engines.push_back(given.one_of(engines)); });
  if (!line.read(words)) return std::nullopt;
  if (a.output.empty()) throw UsageError("--output DIR is missing");
  return a;
}

Plan plan_for(const Arguments& arguments) {
  Plan plan;
  plan.quick = arguments.quick;
  for (ScenePlan& scene : all_scenes()) {
    if (plan.quick && scene.full_only) continue;
    if (chosen(arguments.scenes, scene.name) || chosen(arguments.scenes, scene.group))
      plan.scenes.push_back(std::move(scene));
  }
  for (const EngineModule& module : engine_modules())
    if (chosen(arguments.engines, module.name)) plan.engines.push_back({module, settings_of(module)});
  return plan;
}

std::vector<double> steps_of(const ScenePlan& scene, bool quick) {
  if (scene.steps.empty()) return quick ? kQuickSteps : kSteps;
  return quick ? std::vector<double>{scene.steps.front()} : scene.steps;
}

/// Runs all engines alternately with one scene and step, each round starting with another.
std::vector<std::unique_ptr<Contender>> race(const Plan& plan, const ScenePlan& scene, double step) {
  std::vector<std::unique_ptr<Contender>> contenders;
  for (const auto& [module, settings] : plan.engines)
    for (const std::string& setting : settings)
      contenders.push_back(std::make_unique<Contender>(module, setting, scene, plan.quick, step,
                                                       plan.quick ? kQuickBudget : scene.budget));
  std::vector<Contender*> running;
  for (const auto& contender : contenders) running.push_back(contender.get());
  while (!running.empty()) {
    std::rotate(running.begin(), running.begin() + 1, running.end());
    running.erase(std::remove_if(running.begin(), running.end(),
                                 [](Contender* contender) { return !contender->work(); }),
                  running.end());
  }
  return contenders;
}

void make_folder(const std::string& path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw std::runtime_error("--output: cannot make the folder '" + path + "': " + error.message());
}

/// Charts need Python with matplotlib; without it only tables are written.
void draw_charts(const std::string& csv) {
  const pid_t child = fork();
  if (child == 0) {
    execlp(SPEED_ACCURACY_PYTHON, SPEED_ACCURACY_PYTHON, SPEED_ACCURACY_PLOT_SCRIPT, csv.c_str(), nullptr);
    _exit(127);
  }
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || status != 0)
    std::cerr << "no charts: failed: " SPEED_ACCURACY_PYTHON " " SPEED_ACCURACY_PLOT_SCRIPT " " << csv
              << '\n';
}

std::ofstream opened(const std::string& file) {
  std::ofstream csv(file);
  if (!csv) throw std::runtime_error("cannot write '" + file + "'");
  return csv;
}

int run(const std::optional<Arguments>& read) {
  if (!read) {
    std::cout << "usage: speed_accuracy [--quick] [--scene NAME]... [--engine NAME]... --output DIR\n";
    return 0;
  }
  const Arguments& arguments = *read;
  make_folder(arguments.output);
  const std::string file = arguments.output + "/speed_accuracy.csv";
  std::ofstream csv = opened(file), times = opened(arguments.output + "/step_times.csv");
  write_header(csv);
  write_times_header(times);
  const Plan plan = plan_for(arguments);
  std::map<std::string, std::vector<Measure>> measures;
  const auto begin = std::chrono::steady_clock::now();
  for (const ScenePlan& scene : plan.scenes) {
    if (!scene.missing.empty()) {
      std::cout << scene.name << "  skipped: " << scene.missing << '\n' << std::flush;
      continue;
    }
    if (scene.prepare) scene.prepare(load(engine_modules().front().file));
    for (const double step : steps_of(scene, plan.quick)) {
      const auto contenders = race(plan, scene, step);
      write_rows(csv, scene.name, step, contenders, measures);
      write_times(times, scene.name, step, contenders);
      csv.flush(), times.flush();
    }
    const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - begin;
    std::cout << scene.name << "  " << std::lround(passed.count()) << " s\n" << std::flush;
  }
  csv.close(), times.close();
  draw_charts(file);
  return 0;
}

}  // namespace
}  // namespace mrhi::benchmark

int main(int argc, char** argv) {
  using namespace mrhi::benchmark;
  std::signal(SIGPIPE, SIG_IGN);
  return mrhi::exit_status("speed_accuracy", [&] { return run(read_arguments({argv + 1, argv + argc})); });
}
