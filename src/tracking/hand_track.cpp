#include "mr_hand_interaction/tracking/hand_track.h"

#include <algorithm>

namespace mrhi {

void SampleHistory::push(const Hand& sample, int keep) {
  size = std::min(size + 1, keep);
  for (int i = size - 1; i > 0; --i) {
    samples[static_cast<std::size_t>(i)] = samples[static_cast<std::size_t>(i - 1)];
  }
  samples[0] = sample;
}

Hand blend(const Hand& from, const Hand& to, double fraction) {
  if (fraction >= 1.0) return to;
  Hand hand = to;
  const auto mix = [fraction](const Vector3& a, const Vector3& b) -> Vector3 {
    return a + fraction * (b - a);
  };
  hand.palm.position = mix(from.palm.position, to.palm.position);
  hand.palm.orientation = from.palm.orientation.slerp(fraction, to.palm.orientation).normalized();
  hand.wrist = mix(from.wrist, to.wrist);
  for (std::size_t c = 0; c < kCapsules; ++c) {
    if (from.capsules[c].radius <= 0.0) continue;
    hand.capsules[c].start = mix(from.capsules[c].start, to.capsules[c].start);
    hand.capsules[c].end = mix(from.capsules[c].end, to.capsules[c].end);
  }
  return hand;
}

}  // namespace mrhi
