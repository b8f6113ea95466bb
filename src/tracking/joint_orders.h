#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// The joints of a hand by number: the wrist, then finger by finger.
constexpr std::size_t kHandJoints = 1 + 5 * kFingers;
template <typename Joints>
auto& joint(Joints& hand, std::size_t i) {
  return i == 0 ? hand.wrist : hand.joints[(i - 1) / 5][(i - 1) % 5];
}

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

/// An order in which trackers list the joints of a hand.
struct JointOrder {
  const char* name;
  std::size_t size;   ///< joints of a hand
  std::size_t wrist;  ///< its place in the list
  /// Places of HandJoints::joints[finger]; kNotListed: none.
  std::array<std::array<std::size_t, 5>, kFingers> joints;

  static constexpr std::size_t kNotListed = static_cast<std::size_t>(-1);
};

/// All known orders. Of several of one size the usual one is first.
const std::vector<JointOrder>& joint_orders();
/// Throws std::invalid_argument that lists the known names.
const JointOrder& joint_order(const std::string& name);

/// The hand whose joints are `points`, of the order's size; a point with a coordinate NaN is missing. Radii
/// are of the points too, from a joint to the skin [m], or none: 0 and NaN mean unknown.
HandJoints hand_in_order(const JointOrder& order, const Vector3* points, const float* radii, Side side);

/// Recognises the order of a stream of hands by the lengths of their bones, which are those of a hand only in
/// the right order. It begins with the usual order of that size and changes to another that fits better by
/// kMargin.
class OrderRecognition {
 public:
  /// The order for this hand, of a size that has one. `changed` is set if it was another one before. Throws
  /// std::invalid_argument if bones of no known order are a hand's.
  const JointOrder& order_of(std::size_t size, const Vector3* points, bool& changed);

 private:
  static constexpr double kMargin = 0.08;   // of Proportions::misfit
  static constexpr double kNoHand = 0.45;   // misfit in the best order
  static constexpr double kNewShare = 0.2;  // of a hand in the running means

  std::size_t size_ = 0;
  const JointOrder* chosen_ = nullptr;
  std::vector<std::optional<double>> misfits_;  // running means, as joint_orders() counts
};

}  // namespace mrhi
