#include "mr_hand_interaction/tracking/hand_track.h"

#include <algorithm>
#include <cmath>

#include "../math/minimum_jerk.h"

namespace mrhi {

// With s(u) the share of the way at the share u of the duration T, the hand is at s (way + speed u T) beyond
// where it was held: its acceleration is at most speed/T max|u s'' + 2 s'| + way/T^2 max|s''|.
Nanoseconds rejoin_duration(double way, double away) {
  // What an object endures that is held half as firmly again as its weight needs.
  constexpr double kAcceleration = 5.0;               // [m/s^2]
  constexpr double kShortest = 0.05, kLongest = 0.4;  // [s]
  constexpr double kOfSpeed = 4.63, kOfWay = 5.78;    // the two maxima of minimum jerk
  const double b = kOfSpeed * way / away;
  const double duration = (b + std::sqrt(b * b + 4.0 * kAcceleration * kOfWay * way)) / (2.0 * kAcceleration);
  return static_cast<Nanoseconds>(1e9 * std::clamp(duration, kShortest, kLongest));
}

Hand catching_up(const Rejoin& rejoin, const Hand& tracked, Nanoseconds stamp) {
  const double u = std::min(1.0, to_seconds(stamp - rejoin.begin) / to_seconds(rejoin.duration));
  return blend(rejoin.from, tracked, minimum_jerk(u));
}

double farthest_joint(const Hand& from, const Hand& to) {
  double distance_squared = 0.0;
  for (std::size_t c = 0; c < kCapsules; ++c) {
    const Capsule &a = from.capsules[c], &b = to.capsules[c];
    if (a.radius <= 0.0 || b.radius <= 0.0) continue;
    distance_squared =
        std::max({distance_squared, (a.start - b.start).squaredNorm(), (a.end - b.end).squaredNorm()});
  }
  return std::sqrt(distance_squared);
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
