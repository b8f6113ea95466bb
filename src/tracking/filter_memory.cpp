#include "mr_hand_interaction/tracking/filter_memory.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

template <typename AnyHand>
auto& point_of(AnyHand& hand, std::size_t point) {
  if (point == 0) return hand.palm.position;
  if (point == 1) return hand.wrist;
  auto& capsule = hand.capsules[(point - 2) / 2];
  return point % 2 == 0 ? capsule.start : capsule.end;
}

}  // namespace

/// elapsed[i] goes with samples[i]: since the sample before it, which is samples[i + 1].
void SampleHistory::push(const Hand& sample, double since, int keep) {
  size = std::min(size + 1, keep);
  for (auto i = static_cast<std::size_t>(size - 1); i > 0; --i) {
    samples[i] = samples[i - 1];
    elapsed[i] = elapsed[i - 1];
  }
  samples[0] = sample;
  elapsed[0] = since;
}

const Vector3& hand_point(const Hand& hand, std::size_t point) {
  return point_of(hand, point);
}
Vector3& hand_point(Hand& hand, std::size_t point) {
  return point_of(hand, point);
}

bool has_point(const Hand& hand, std::size_t point) {
  return point < 2 || hand.capsules[(point - 2) / 2].radius > 0.0;
}

/// Only of the capsules' ends: palm and wrist are always there, estimated where they are not seen. A joint
/// that two bones share counts twice.
double rms_speed(const HandVelocity& velocity, const Hand& hand) {
  double sum = 0.0;
  int count = 0;
  for (std::size_t point = 2; point < kHandPoints; ++point) {
    if (!has_point(hand, point)) continue;
    sum += velocity.points[point].squaredNorm();
    ++count;
  }
  return count > 0 ? std::sqrt(sum / count) : 0.0;
}

/// What is known of the tracker's noise stays: it is not the hand's.
void FilterMemory::restart(const Hand& sample) {
  history.size = 0;
  history.push(sample, 0.0, 1);
  filtered = sample;
  velocity = HandVelocity();
  variance = MotionVariance();
}

}  // namespace mrhi
