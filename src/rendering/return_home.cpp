#include "return_home.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

constexpr double kTimeConstant = 0.05;  // [s]
constexpr double kLongestWay = 0.0008;  // in a frame, of the hand, and again of a finger on it [m]
constexpr double kHome = 1e-6;          // nearer than this is back [m]

/// What is left of an offset that reaches this far.
double share_left(double way, double decayed) {
  if (way <= kHome) return 0.0;
  return 1.0 - std::min(1.0 - decayed, kLongestWay / way);
}

}  // namespace

bool HandOffset::zero() const {
  for (const FingerOffset& finger : fingers) {
    if (!(finger == 0.0).all()) return false;
  }
  return shift == Vector3::Zero();
}

HandOffset returning(const HandOffset& offset, Nanoseconds stamp, HandChain& chain) {
  HandOffset left = offset;
  if (offset.zero()) return left;
  const double decayed = std::exp(-to_seconds(stamp - offset.stamp) / kTimeConstant);
  left.shift *= share_left(offset.shift.norm(), decayed);
  for (int f = 0; f < kFingers; ++f) {
    FingerOffset& turned = left.fingers[static_cast<std::size_t>(f)];
    if ((turned == 0.0).all()) continue;
    const FingerChain& finger = chain.finger(f);
    turned = turned.max(finger.lower()).min(finger.upper());
    turned *= share_left(finger.way(turned), decayed);
  }
  return left;
}

}  // namespace mrhi
