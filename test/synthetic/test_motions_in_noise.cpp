#include <gtest/gtest.h>

#include "synthetic/performance.h"
#include "training/operator_trial.h"

namespace mrhi {
namespace {

using testing::Staging;

/// A tracker that is as noisy as a good one, and ten times worse.
struct Tracker {
  double noise, rate;  // [m] on every joint, [1/s]
};

class GraspInNoise : public ::testing::TestWithParam<Tracker> {
 protected:
  /// Of so many seeds how many are held from when the cube is carried until the hand opens.
  int held(Staging staging, int seeds) const {
    const ScriptedMotion motion = make_motion("grasp_cube");
    staging.noise = GetParam().noise;
    staging.rate = GetParam().rate;
    int count = 0;
    for (int seed = 1; seed <= seeds; ++seed) {
      staging.seed = static_cast<std::uint64_t>(seed);
      const auto moments = testing::perform("grasp_cube", staging);
      if (testing::held_throughout(moments, testing::carrying_from(motion), testing::opening_from(motion)))
        ++count;
    }
    return count;
  }
};

TEST_P(GraspInNoise, holds_without_a_parameter_in_weightlessness) {
  EXPECT_EQ(held(Staging(), 5), 5);
}

TEST_P(GraspInNoise, holds_without_a_parameter_on_a_table) {
  Staging staging;
  staging.gravity = -9.81;
  staging.stand = stand_under;
  EXPECT_EQ(held(staging, 5), 5);
}

INSTANTIATE_TEST_SUITE_P(trackers, GraspInNoise,
                         ::testing::Values(Tracker{0.001, 30}, Tracker{0.003, 30}, Tracker{0.003, 120},
                                           Tracker{0.005, 60}));

}  // namespace
}  // namespace mrhi
