#pragma once

#include "finger_chain.h"

namespace mrhi {

/// How readily the whole hand gives way, beside its joints (FingerChain::compliance).
constexpr double kShiftCompliance = 0.3;

/// A tracked hand as a palm, which can be shifted, and five fingers on it. A finger's chain is made once it
/// is asked for: most of them touch nothing.
class HandChain {
 public:
  /// Keeps a reference.
  void begin(const Hand& tracked, const PalmLag& lag = PalmLag());

  /// The hand with its offset, which keeps within limits from here on.
  void place(const HandOffset& offset, Hand& placed);
  /// A finger, as last placed.
  FingerChain& finger(int index);

  /// Where a capsule moves by itself: its finger, or none if it moves with the palm.
  static int finger_that_moves(int capsule) {
    return capsule == kPalm || bone_of(capsule) == 0 ? -1 : finger_of(capsule);
  }

 private:
  const Hand* tracked_ = nullptr;
  const Hand* lags_behind_ = nullptr;
  Hand turned_;                      // what tracked_ is where the palm lags
  Vector3 shift_ = Vector3::Zero();  // as last placed
  std::array<FingerChain, kFingers> fingers_;
  std::array<bool, kFingers> known_{};
};

}  // namespace mrhi
