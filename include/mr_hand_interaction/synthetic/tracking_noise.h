#pragma once

#include <cstdint>

#include "mr_hand_interaction/synthetic/random.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Noise like that of a Leap Motion: white on every joint, 0.2 mm rms when still and 1.2 mm from 1 m/s on,
/// and 0.2 mm rms common to the whole hand, all times `amplitude`. The same seed and frames give the same
/// bits.
class TrackingNoise {
 public:
  TrackingNoise(double amplitude, std::uint64_t seed) : amplitude_(amplitude), random_(seed) {}

  /// Disturbs a frame; frames in the order of their stamps.
  void apply(JointsFrame& frame);

 private:
  void disturb(HandJoints& hand, const HandJoints* before, double elapsed);

  double amplitude_;
  Random random_;
  JointsFrame previous_;
};

}  // namespace mrhi
