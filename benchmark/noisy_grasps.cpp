// Rate of grasps that a scripted hand makes and holds with a tracker of this noise and rate: noisy_grasps
// MOTION [SEEDS]. Prints CSV: held from carrying until the hand opens, percent of the seeds, with estimated
// noise and with a good tracker's.

#include <cstdlib>
#include <iostream>
#include <stdexcept>

#include "synthetic/performance.h"
#include "text/files.h"
#include "training/operator_trial.h"

namespace mrhi {
namespace {

int share_held(const std::string& motion, testing::Staging staging, int seeds) {
  const ScriptedMotion script = make_motion(motion);
  int held = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    staging.seed = static_cast<std::uint64_t>(seed);
    const auto moments = testing::perform(motion, staging);
    if (testing::held_throughout(moments, testing::carrying_from(script), testing::opening_from(script)))
      ++held;
  }
  return 100 * held / seeds;
}

void write_row(const std::string& motion, const testing::Staging& estimated, int seeds) {
  testing::Staging fixed = estimated;
  fixed.filter.noise = kUsualNoise;
  const std::string place = estimated.stand != nullptr ? "table" : "0 g";
  (CsvRows(std::cout) << motion << place << 1e3 * estimated.noise << estimated.correlation
                      << estimated.dropped << estimated.rate << share_held(motion, estimated, seeds)
                      << share_held(motion, fixed, seeds))
      .end_row();
  std::cout.flush();
}

/// Properties of a stream's noise besides its size.
struct Colour {
  double correlation, dropped;
};

void write_table(const std::string& motion, bool table, const Colour& colour, int seeds) {
  for (const double noise : {0.0003, 0.001, 0.002, 0.003, 0.005}) {
    for (const double rate : {30.0, 60.0, 90.0, 120.0}) {
      testing::Staging staging;
      staging.noise = noise;
      staging.rate = rate;
      staging.correlation = colour.correlation;
      staging.dropped = colour.dropped;
      staging.stand = table ? stand_under : nullptr;
      staging.gravity = table ? -9.81 : 0.0;
      write_row(motion, staging, seeds);
    }
  }
}

}  // namespace
}  // namespace mrhi

int main(int argc, char** argv) {
  const int seeds = argc == 3 ? std::atoi(argv[2]) : 10;
  if (argc < 2 || argc > 3 || seeds < 1) {
    std::cerr << "usage: noisy_grasps MOTION [SEEDS]\n";
    return 2;
  }
  try {
    mrhi::make_motion(argv[1]);
  } catch (const std::invalid_argument& error) {
    std::cerr << "noisy_grasps: " << error.what() << '\n';
    return 2;
  }
  std::cout << "motion,where,noise_mm,correlation,dropped,frames_per_s,held_estimated,held_fixed\n";
  for (const mrhi::Colour& colour : {mrhi::Colour{0.0, 0.0}, {0.5, 0.0}, {0.8, 0.0}, {0.0, 0.2}}) {
    for (const bool table : {false, true}) mrhi::write_table(argv[1], table, colour, seeds);
  }
  return 0;
}
