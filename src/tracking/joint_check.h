#pragma once

#include <cstddef>
#include <optional>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// A hand beside the adult's of hand_anatomy.h.
struct Proportions {
  double size;  ///< common factor of its bones to the adult's: the median of their ratios
  double
      misfit;  ///< mean of |ln(ratio / size)|: below 0.1 of a hand, 0.3 and more of joints in a wrong order
};

/// By the lengths of all bones and the distances from the wrist to the knuckles that are known. Nothing if
/// these are fewer than kBonesToJudge.
std::optional<Proportions> proportions(const HandJoints& hand);
constexpr std::size_t kBonesToJudge = 8;

/// Drops joints that are at a placeholder: the origin, and any point at which joints of two fingers are
/// exactly. A tracker writes them for what it does not see. Keeps the wrist at the origin if
/// `wrist_is_origin`: some trackers report a hand relative to its wrist. Returns how many joints it drops.
std::size_t drop_placeholders(HandJoints& hand, bool wrist_is_origin = false);

/// Drops joints that make a bone impossibly long, at most a third of those known. Returns how many.
std::size_t drop_stray_joints(HandJoints& hand);

bool has_joints(const HandJoints& hand);

/// All lengths by a factor: a tracker's unit in metres.
void scale(HandJoints& hand, double factor);

}  // namespace mrhi
