#include "mr_hand_interaction/synthetic/tracking_noise.h"

#include <algorithm>

namespace mrhi {
namespace {

constexpr double kStill = 0.0002, kFast = 0.0012, kCommon = 0.0002;  // [m] rms
constexpr double kFastSpeed = 1.0;                                   // [m/s]

/// splitmix64 (Steele, Lea & Flood 2014).
std::uint64_t next(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

const HandJoints* find(const JointsFrame& frame, std::uint32_t id) {
  for (const HandJoints& hand : frame.hands) {
    if (hand.id == id) return &hand;
  }
  return nullptr;
}

}  // namespace

void TrackingNoise::apply(JointsFrame& frame) {
  if (amplitude_ == 0.0) return;
  const JointsFrame clean = frame;
  const double elapsed = to_seconds(frame.stamp - previous_.stamp);
  for (HandJoints& hand : frame.hands) disturb(hand, find(previous_, hand.id), elapsed);
  previous_ = clean;
}

void TrackingNoise::disturb(HandJoints& hand, const HandJoints* before, double elapsed) {
  const Vector3 common = gaussian_vector(amplitude_ * kCommon);
  if (hand.palm_centre) *hand.palm_centre += common;
  if (hand.wrist) *hand.wrist += common;
  for (std::size_t finger = 0; finger < kFingers; ++finger) {
    for (std::size_t j = 0; j < hand.joints[finger].size(); ++j) {
      auto& joint = hand.joints[finger][j];
      if (!joint) continue;
      double speed = 0.0;
      if (before != nullptr && elapsed > 0.0 && before->joints[finger][j]) {
        speed = (*joint - *before->joints[finger][j]).norm() / elapsed;
      }
      const double deviation = kStill + (kFast - kStill) * std::min(1.0, speed / kFastSpeed);
      *joint += common + gaussian_vector(amplitude_ * deviation);
    }
  }
  // Leap's empty thumb metacarpal stays empty.
  if (hand.joints[0][0] && hand.joints[0][1]) hand.joints[0][0] = hand.joints[0][1];
}

/// Sum of twelve uniform numbers: only additions, so the bits do not depend on a mathematics library.
double TrackingNoise::gaussian() {
  double sum = -6.0;
  for (int i = 0; i < 12; ++i) sum += static_cast<double>(next(state_) >> 11) * 0x1.0p-53;
  return sum;
}

Vector3 TrackingNoise::gaussian_vector(double deviation) {
  const double x = gaussian(), y = gaussian(), z = gaussian();
  return deviation * Vector3(x, y, z);
}

}  // namespace mrhi
