#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

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
