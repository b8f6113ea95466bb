#pragma once

#include <array>
#include <optional>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Joints that a tracker loses for moments stay with their hand: each is moved on as those that are seen
/// before and after have moved together (three, not in one line, must be). For trackers that report at most
/// one hand of a side. By stamps alone, so that a replay does as the live node.
class JointGaps {
 public:
  static constexpr Nanoseconds kLongest = 200'000'000;  ///< as tracking/hold_time ships

  /// Puts in what was seen no longer ago than kLongest.
  void fill(JointsFrame& frame);

 private:
  static constexpr std::size_t kJoints = 1 + 5 * kFingers;  // the wrist, then finger by finger
  using Points = std::array<std::optional<Vector3>, kJoints>;
  struct Memory {
    Nanoseconds stamp = 0;
    Points points;                            ///< with what was put in
    std::array<Nanoseconds, kJoints> seen{};  ///< when each was last

    void move_on(const Points& now);
    void take(HandJoints& hand, Nanoseconds at);
  };

  std::array<Memory, 2> sides_;
};

}  // namespace mrhi
