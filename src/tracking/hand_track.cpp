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
  // With s = 10 u^3 - 15 u^4 + 6 u^5: max |120 u^2 - 300 u^3 + 180 u^4| at u = 0.386, and max |s''| = 10 /
  // sqrt(3) at u = (3 - sqrt(3)) / 6. Then a T^2 = b T + kOfWay way, of which T is the positive root.
  const double b = kOfSpeed * way / away;
  const double duration = (b + std::sqrt(b * b + 4.0 * kAcceleration * kOfWay * way)) / (2.0 * kAcceleration);
  return static_cast<Nanoseconds>(1e9 * std::clamp(duration, kShortest, kLongest));
}

///     x = from + s(u) (tracked - from),   u = (t - begin) / duration,   s' = s'' = 0 at both ends
/// It begins at rest, as the held hand was, and ends with the tracked hand's velocity. The duration is fixed
/// at the start, for a hand that goes on as fast.
Hand catching_up(const Rejoin& rejoin, const Hand& tracked, Nanoseconds stamp) {
  const double u = std::min(1.0, to_seconds(stamp - rejoin.begin) / to_seconds(rejoin.duration));
  return blend(rejoin.from, tracked, minimum_jerk(u));
}

/// Squares are compared, and one root is taken: the same bits, as a root keeps the order.
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

/// Quaternions by the shorter arc at one rate (slerp: Shoemake 1985), points on lines. At 1 it is `to` to the
/// last bit: a hand that has caught up owes nothing to where it was. A capsule that only one of them has is
/// as in `to`.
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
