// Plays hand recordings with bodies in the hands' paths, and checks every rendered hand: how many jump,
// penetrate a body, or exceed their joints' limits. docs/pipeline.md.
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <stdexcept>

#include "mr_hand_interaction/replay/recording_csv.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "support/random_way.h"
#include "support/recorded_frames.h"
#include "support/rendered_check.h"

namespace mrhi::benchmark {
namespace {

using testing::RenderedCheck;

struct Sum {
  long frames = 0, aside = 0, shown_in = 0, jumps = 0;
  double jump = 0.0, depth = 0.0, angle = 0.0, length = 0.0;

  void add(const RenderedCheck& check) {
    frames += check.frames, aside += check.moved_aside, shown_in += check.shown_in, jumps += check.jumps;
    jump = std::max(jump, check.jump.value), depth = std::max(depth, check.depth.value);
    angle = std::max({angle, check.angle.value, check.thumb_angle.value});
    length = std::max({length, check.length.value, check.apart.value});
  }
  void print(const std::string& what) const {
    std::printf("%-6s %8ld %8ld %6ld %6ld %8.2f %8.3f %8.4f %8.1e\n", what.c_str(), frames, aside, shown_in,
                jumps, 1e3 * jump, 1e3 * depth, angle, 1e3 * length);
    std::fflush(stdout);
  }
};

int play(int seeds) {
  const bool verbose = std::getenv("VERBOSE") != nullptr;
  std::printf("%-6s %8s %8s %6s %6s %8s %8s %8s %8s\n", "seed", "hands", "aside", "in", "jumps", "jump/mm",
              "depth/mm", "angle", "bone/mm");
  Sum all;
  std::vector<std::pair<std::string, std::vector<HandFrame>>> recorded;
  for (const std::string& file : testing::recordings())
    recorded.emplace_back(file, testing::recorded_frames(file));
  for (int seed = 0; seed <= seeds; ++seed) {
    Sum sum;
    if (const char* only = std::getenv("SEED"); only != nullptr && seed != std::atoi(only)) continue;
    for (const auto& [file, frames] : recorded) {
      if (const char* only = std::getenv("ONLY"); only != nullptr && file.find(only) == std::string::npos)
        continue;
      Simulation simulation(testing::scene_at_random(frames, static_cast<std::uint64_t>(seed)),
                            Configuration());
      RenderedCheck check(simulation.scene());
      for (const HandFrame& frame : frames) {
        if (simulation.advance(frame) == Rejection::none) check.see(simulation);
      }
      if (verbose) {
        for (const auto& jump : check.all_jumps)
          std::printf("  %s %.3f: %.2f mm\n", file.c_str(), jump.time, 1e3 * jump.value);
      }
      sum.add(check);
      all.add(check);
    }
    sum.print(std::to_string(seed));
  }
  all.print("all");
  return 0;
}

}  // namespace
}  // namespace mrhi::benchmark

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: MR_HAND_RECORDINGS=FOLDER rendered_jumps SEEDS\n";
    return 2;
  }
  return mrhi::benchmark::play(std::atoi(argv[1]));
}
