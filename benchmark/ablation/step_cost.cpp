#include "variant.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <memory>

namespace mrhi::ablation {
namespace {

constexpr double kRate = 1000.0;  // frames and steps per second

class SceneA {
 public:
  explicit SceneA(const Variant& variant)
      : pinch_(variant.pinch), simulation_(pinch_.scene(), variant.configuration) {}

  /// Time of the frame's step alone [ns].
  double advance(int frame) {
    const double t = frame / kRate;
    const Vector3 sway = testing::smooth(t - 0.5, 0.5) * testing::swing(t - 0.5, 0.1, 0.5);
    simulation_.begin({testing::at(t), {pinch_.hand(t, sway)}});
    const auto begin = std::chrono::steady_clock::now();
    simulation_.step();
    const std::chrono::duration<double, std::nano> time = std::chrono::steady_clock::now() - begin;
    while (simulation_.step()) {
    }
    simulation_.end();
    return time.count();
  }

 private:
  testing::PinchScene pinch_;
  Simulation simulation_;
};

}  // namespace

void run_scene_a(const Variant& variant) {
  SceneA scene(variant);
  for (int frame = 0; frame <= kSteps; ++frame) scene.advance(frame);
}

std::vector<double> times_of_a_step(const std::vector<Variant>& variants) {
  constexpr int kTurn = 50, kWarm = 10;  // steps per turn, and before it to fill the caches
  std::vector<std::unique_ptr<SceneA>> scenes;
  for (const Variant& variant : variants) scenes.push_back(std::make_unique<SceneA>(variant));
  std::vector<std::vector<double>> times(variants.size());
  for (int from = 0; from < kSteps; from += kTurn) {
    for (std::size_t i = 0; i < scenes.size(); ++i) {
      for (int frame = from; frame < from + kTurn; ++frame) {
        const double time = scenes[i]->advance(frame);
        if (frame >= from + kWarm) times[i].push_back(time);
      }
    }
  }
  std::vector<double> medians;
  for (std::vector<double>& of_one : times) {
    const auto middle = of_one.begin() + static_cast<std::ptrdiff_t>(of_one.size() / 2);
    std::nth_element(of_one.begin(), middle, of_one.end());
    medians.push_back(*middle);
  }
  return medians;
}

double instructions_of_a_step(const std::string& program, const std::string& refinement) {
  const std::string command =
      "valgrind --tool=callgrind --callgrind-out-file=/dev/null "
      "--toggle-collect='mrhi::Simulation::step()' '" +
      program + "' --steps " + refinement + " 2>&1";
  std::FILE* output = popen(command.c_str(), "r");
  if (output == nullptr) return -1.0;
  double collected = -1.0;
  char line[512];
  while (std::fgets(line, sizeof line, output) != nullptr) {
    const char* const found = std::strstr(line, "Collected :");
    if (found != nullptr) collected = std::atof(found + std::strlen("Collected :"));
  }
  pclose(output);
  return collected > 0.0 ? collected / kSteps : -1.0;
}

}  // namespace mrhi::ablation
