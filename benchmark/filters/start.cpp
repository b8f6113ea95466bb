#include "scores.h"

#include <algorithm>
#include <cmath>

#include "math/minimum_jerk.h"
#include "mr_hand_interaction/tracking/hand_skeleton.h"
#include "support/white_noise.h"
#include "tracking/hand_filter.h"

namespace mrhi::filter_benchmark {
namespace {

constexpr double kAppears = 0.7, kStart = 1.5;  // still settling until then; sets off [s]

struct Reach {
  double distance, duration;  // [m], [s]
};

HandJoints hand_at(const Vector3& wrist) {
  Pose pose;
  pose.position = wrist;
  return hand_joints(human_hand(), Side::right, pose, relaxed_posture());
}

Start start_of(const Reach& reach, std::uint64_t seed, const FilterConfiguration& filter, double noise,
               double rate) {
  testing::JointNoise tracker(noise, seed);
  FilterMemory memory;
  Start start;
  double squares = 0.0;
  int still = 0;
  for (int frame = 0; frame < (kStart + reach.duration + 0.2) * rate; ++frame) {
    const double u = (frame / rate - kStart) / reach.duration;
    const Vector3 along(0.6, 0.8, 0.0);
    HandJoints joints = hand_at(reach.distance * minimum_jerk(std::clamp(u, 0.0, 1.0)) * along);
    const Hand truth = complete_hand(joints, Pose{});
    tracker.apply(joints);
    const Hand shown = filtered(complete_hand(joints, Pose{}), frame > 0 ? 1.0 / rate : 0.0, filter, memory);
    double behind = 0.0, error = 0.0;
    int known = 0;
    for (int c = 0; c < kPhalanges; ++c) {
      if (!truth.has(c)) continue;
      const Vector3 away = truth.capsules[c].end - shown.capsules[c].end;
      behind += away.dot(along);
      error += away.squaredNorm() / 3.0;
      ++known;
    }
    if (u > 0.0) start.lag = std::max(start.lag, std::abs(behind) / known);
    if (u > 0.0 || frame / rate < kAppears) continue;
    squares += error / known;
    ++still;
  }
  start.rest = std::sqrt(squares / still);
  return start;
}

}  // namespace

Start start_of_a_reach(const FilterConfiguration& filter, double noise, double rate) {
  constexpr std::uint64_t kSeeds = 4;
  Start worst;
  for (const Reach& reach : {Reach{0.3, 0.5}, Reach{0.4, 0.75}, Reach{0.5, 1.0}}) {
    for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
      const Start start = start_of(reach, seed, filter, noise, rate);
      worst = {std::max(worst.lag, start.lag), std::max(worst.rest, start.rest)};
    }
  }
  return worst;
}

}  // namespace mrhi::filter_benchmark
