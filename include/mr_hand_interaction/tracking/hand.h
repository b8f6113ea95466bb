#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

enum class Side : std::uint8_t { left = 0, right = 1 };

constexpr int kFingers = 5;         ///< thumb, index, middle, ring, little
constexpr int kBonesPerFinger = 4;  ///< metacarpal, proximal, intermediate, distal
constexpr int kPhalanges = kFingers * kBonesPerFinger;
constexpr int kPalm = kPhalanges;  ///< index of the palm's capsule
constexpr int kCapsules = kPhalanges + 1;

constexpr int capsule_index(int finger, int bone) {
  return finger * kBonesPerFinger + bone;
}
constexpr int finger_of(int capsule) {
  return capsule / kBonesPerFinger;
}  ///< 5 for the palm
constexpr int bone_of(int capsule) {
  return capsule % kBonesPerFinger;
}  ///< 0 for the palm

/// One hand at one time, in world. A capsule with radius 0 was not reported by the tracker.
struct Hand {
  std::uint32_t id = 0;
  Side side = Side::right;
  double confidence = 1.0;      ///< 0..1
  double grab_strength = 0.0;   ///< 0..1
  double pinch_strength = 0.0;  ///< 0..1
  Pose palm;                    ///< centre of the palm; x towards the fingers, z out of the back of the hand
  double palm_width = 0.0;      ///< [m]
  Vector3 wrist = Vector3::Zero();
  std::array<Capsule, kCapsules> capsules;

  bool has(int capsule) const { return capsules[static_cast<std::size_t>(capsule)].radius > 0.0; }
};

/// Hands reported by the tracker at one time.
struct HandFrame {
  Nanoseconds stamp = 0;
  std::vector<Hand> hands;
};

}  // namespace mrhi
