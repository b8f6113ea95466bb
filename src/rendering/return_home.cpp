#include "return_home.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

constexpr double kTimeConstant = 0.05;   // [s]
constexpr double kLongestWay = 0.0008;   // in a frame, of the hand, and again of a finger on it [m]
constexpr double kHome = 1e-6;           // nearer than this is back [m]
constexpr double kLongestTurn = 0.0004;  // in a frame, of a fingertip with the palm [m]
constexpr double kHandReach = 0.15;      // of the hand from its palm's position [m]
constexpr double kFingerReach = 0.1;     // of a finger from its root [m]

/// What is left of an offset that reaches this far. An offset of the size `way` goes back by the part 1 -
/// exp(-t / 50 ms), but by no more than `longest`: exponential when near, a constant way a frame when far.
double share_left(double way, double decayed, double longest = kLongestWay) {
  if (way <= kHome) return 0.0;
  return 1.0 - std::min(1.0 - decayed, longest / way);
}

Quaternion turned_back(const Quaternion& turn, double reach, double decayed) {
  const double angle = turn.angularDistance(Quaternion::Identity());
  const double left = share_left(reach * angle, decayed, kLongestTurn);
  return left == 0.0 ? Quaternion::Identity() : Quaternion::Identity().slerp(left, turn);
}

double decayed_share(const HandOffset& offset, Nanoseconds stamp) {
  return std::exp(-to_seconds(stamp - offset.stamp) / kTimeConstant);
}

}  // namespace

bool HandOffset::zero() const {
  if (!lag.zero()) return false;
  for (const FingerOffset& finger : fingers) {
    if (!(finger == 0.0).all()) return false;
  }
  return shift == Vector3::Zero();
}

PalmLag lag_returning(const HandOffset& offset, Nanoseconds stamp) {
  PalmLag left;
  if (offset.lag.zero()) return left;
  const double decayed = decayed_share(offset, stamp);
  left.whole = turned_back(offset.lag.whole, kHandReach, decayed);
  left.frame = turned_back(offset.lag.frame, kFingerReach, decayed);
  return left;
}

/// Limits are those of the hand as it is now: an offset that was right a frame ago may be beyond them.
HandOffset returning(const HandOffset& offset, Nanoseconds stamp, HandChain& chain) {
  HandOffset left = offset;
  if (offset.zero()) return left;
  left.lag = lag_returning(offset, stamp);
  const double decayed = decayed_share(offset, stamp);
  left.shift *= share_left(offset.shift.norm(), decayed);
  for (int f = 0; f < kFingers; ++f) {
    FingerOffset& turned = left.fingers[static_cast<std::size_t>(f)];
    if ((turned == 0.0).all() && left.lag.zero()) continue;
    const FingerChain& finger = chain.finger(f);
    turned = turned.max(finger.lower()).min(finger.upper());
    turned *= share_left(finger.way(turned), decayed);
    if (!left.lag.zero()) turned = turned.max(finger.lower()).min(finger.upper());
  }
  return left;
}

}  // namespace mrhi
