#pragma once

#include <cstdint>
#include <string>

namespace mrhi {

/// How well a simulated operator does things. docs/simulated_operators.md says where the figures come from.
struct OperatorSkill {
  double reaction_time = 0.2;     ///< until what is seen is acted on [s]
  double movement_start = 0.2;    ///< a of Fitts' law: duration = a + b log2(distance / width + 1) [s]
  double movement_per_bit = 0.2;  ///< b [s/bit]
  double pace = 1.0;              ///< factor on how long closing, opening and withdrawing take
  double decision_time = 0.3;     ///< between seeing that one thing is done and beginning the next [s]
  double placing_error = 0.0;     ///< of the hand about the object, deviation on an axis [m]
  double turning_error = 0.0;     ///< likewise about an axis [rad]
  double precision = 0.008;       ///< a place missed by more than this is corrected [m]
  double tremor = 0.0;            ///< of the hand, 8 to 12 Hz, rms on an axis [m]
  double least_grip = 2.5;        ///< that it holds with what has no load [N]
  double grip_margin = 1.0;       ///< of the grip beyond that, above what the load needs in order not to slip
  double grip_depth = 0.018;      ///< thumb and fingers together close no farther beyond the surface [m]
  double grip_spread = 0.0;       ///< deviation of each tip's share of the depth
  double opening = 0.018;         ///< gap between each tip and the object before closing [m]
};

OperatorSkill beginner_skill();
OperatorSkill veteran_skill();

/// One person of the group ("beginner" or "veteran"): each figure of the group's with a deviation of a fifth.
/// Throws std::invalid_argument that lists the groups.
OperatorSkill draw_skill(const std::string& group, std::uint64_t seed);

}  // namespace mrhi
