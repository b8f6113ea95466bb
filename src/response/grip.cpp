#include "mr_hand_interaction/response/grip.h"

namespace mrhi {
namespace {

Vector3 mean_tip(const Grip& grip, const Hand& hand) {
  Vector3 sum = Vector3::Zero();
  int count = 0;
  for (int finger = 0; finger < kFingers; ++finger) {
    if (!grip.takes_part(finger)) continue;
    sum += tip_of(hand, finger);
    ++count;
  }
  return sum / count;
}

}  // namespace

Vector3 tip_of(const Hand& hand, int finger) {
  return hand.capsules[static_cast<std::size_t>(capsule_index(finger, 3))].end;
}

Vector3 base_of(const Hand& hand, bool by_palm) {
  return by_palm ? hand.palm.position : tip_of(hand, 0);
}

double opening(const Grip& grip, const Hand& hand) {
  return (mean_tip(grip, hand) - base_of(hand, grip.by_palm)).norm();
}

Vector3 middle(const Grip& grip, const Hand& hand) {
  return hand.palm.to_local(0.5 * (mean_tip(grip, hand) + base_of(hand, grip.by_palm)));
}

Pose grip_frame(const Hand& hand, const Vector3& middle) {
  return {hand.palm * middle, hand.palm.orientation};
}

}  // namespace mrhi
