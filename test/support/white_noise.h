#pragma once

#include <cmath>
#include <optional>
#include <vector>

#include "mr_hand_interaction/synthetic/random.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi::testing {

/// Noise on every joint of one hand by itself, `deviation` [m] rms on an axis; with `correlation` above 0 it
/// is coloured: so much of it is left from one frame to the next.
class JointNoise {
 public:
  JointNoise(double deviation, std::uint64_t seed, double correlation = 0.0)
      : deviation_(deviation), correlation_(correlation), random_(seed) {}

  void apply(HandJoints& hand) {
    std::size_t next = 0;
    const auto disturb = [&](std::optional<Vector3>& point) {
      if (point) *point += noise(next++);
    };
    disturb(hand.palm_centre);
    disturb(hand.wrist);
    for (auto& finger : hand.joints)
      for (auto& joint : finger) disturb(joint);
    if (hand.joints[0][0]) hand.joints[0][0] = hand.joints[0][1];  // Leap's thumb has no metacarpal
  }

 private:
  const Vector3& noise(std::size_t point) {
    if (point == noises_.size()) {
      noises_.push_back(random_.gaussian_vector(deviation_));
    } else {
      const double fresh = std::sqrt(1.0 - correlation_ * correlation_);
      noises_[point] = correlation_ * noises_[point] + Vector3(random_.gaussian_vector(fresh * deviation_));
    }
    return noises_[point];
  }

  double deviation_, correlation_;
  Random random_;
  std::vector<Vector3> noises_;
};

}  // namespace mrhi::testing
