#pragma once

#include <array>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// What a phalanx or the palm presses with, all its contacts together.
struct Pressed {
  double force = 0.0;               ///< size of the normal forces' sum [N]
  Vector3 point = Vector3::Zero();  ///< middle of where it touches, world [m]
};

/// One hand as shown: outside every object.
struct RenderedHand {
  Hand hand;
  std::array<bool, kCapsules> touching{};
  std::array<Pressed, kCapsules> pressed{};  ///< of those that touch
};

}  // namespace mrhi
