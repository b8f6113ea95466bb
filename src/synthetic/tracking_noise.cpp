#include "mr_hand_interaction/synthetic/tracking_noise.h"

#include <algorithm>

namespace mrhi {
namespace {

constexpr double kStill = 0.0002, kFast = 0.0012, kCommon = 0.0002;  // [m] rms
constexpr double kFastSpeed = 1.0;                                   // [m/s]

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
  const Vector3 common = random_.gaussian_vector(amplitude_ * kCommon);
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
      *joint += common + random_.gaussian_vector(amplitude_ * deviation);
    }
  }
  // Leap's empty thumb metacarpal stays empty.
  if (hand.joints[0][0] && hand.joints[0][1]) hand.joints[0][0] = hand.joints[0][1];
}

}  // namespace mrhi
