#include "person.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "mr_hand_interaction/synthetic/random.h"

namespace mrhi {
namespace {

constexpr double kDegree = M_PI / 180.0;
constexpr double kSpread = 0.2, kLeast = 0.5, kMost = 1.6;  // of one person against the group

constexpr double OperatorSkill::*kPersonal[] = {
    &OperatorSkill::reaction_time, &OperatorSkill::movement_start, &OperatorSkill::movement_per_bit,
    &OperatorSkill::pace,          &OperatorSkill::decision_time,  &OperatorSkill::placing_error,
    &OperatorSkill::turning_error, &OperatorSkill::tremor,         &OperatorSkill::grip_depth,
    &OperatorSkill::least_grip,    &OperatorSkill::grip_margin};

}  // namespace

OperatorSkill beginner_skill() {
  OperatorSkill skill;
  skill.reaction_time = 0.25;
  skill.movement_per_bit = 0.30;
  skill.pace = 1.0;
  skill.decision_time = 0.6;
  skill.placing_error = 0.006;
  skill.turning_error = 6.0 * kDegree;
  skill.tremor = 0.0004;
  skill.least_grip = 3.0;
  skill.grip_margin = 1.2;
  skill.grip_depth = 0.021;
  skill.grip_spread = 0.2;
  return skill;
}

OperatorSkill veteran_skill() {
  OperatorSkill skill;
  skill.reaction_time = 0.20;
  skill.movement_per_bit = 0.20;
  skill.pace = 0.75;
  skill.decision_time = 0.3;
  skill.placing_error = 0.003;
  skill.turning_error = 3.0 * kDegree;
  skill.tremor = 0.0002;
  skill.least_grip = 2.5;
  skill.grip_margin = 1.0;
  skill.grip_depth = 0.018;
  skill.grip_spread = 0.1;
  return skill;
}

OperatorSkill draw_skill(const std::string& group, std::uint64_t seed) {
  if (group != "beginner" && group != "veteran")
    throw std::invalid_argument("group '" + group + "' is not known: use one of beginner, veteran");
  OperatorSkill skill = group == "beginner" ? beginner_skill() : veteran_skill();
  Random random(seed);
  for (const auto figure : kPersonal)
    skill.*figure *= std::min(kMost, std::max(kLeast, 1.0 + kSpread * random.gaussian()));
  return skill;
}

Tremor::Tremor(double rms, Random& random) {
  constexpr int kWaves = 3;
  for (int i = 0; i < kWaves; ++i) {
    const double frequency = 8.0 + 4.0 * random.uniform(), phase = 2.0 * M_PI * random.uniform();
    waves_.push_back({frequency, phase, random.gaussian_vector(rms * std::sqrt(2.0 / kWaves))});
  }
}

Vector3 Tremor::at(double time) const {
  Vector3 sum = Vector3::Zero();
  for (const Wave& wave : waves_)
    sum += std::sin(2.0 * M_PI * wave.frequency * time + wave.phase) * wave.amplitude;
  return sum;
}

}  // namespace mrhi
