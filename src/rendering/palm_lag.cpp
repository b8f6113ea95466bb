#include "renderer.h"

namespace mrhi {
namespace {

constexpr double kHeld = 0.0005;    // joints that their limits keep from staying by less do not matter [m]
constexpr double kFirstTurn = 0.2;  // of the search for axes of the palm in which they can [rad]
constexpr double kLastTurn = 0.02;  // [rad]
constexpr double kFlatPalm = 1e-4;  // less than this is no palm [m^2]

/// Axes of a palm by its bones: wrist and roots of index and little finger. By its orientation if it has
/// none. x between the roots of index and little finger as seen from the wrist, z across both, y = z x x. z
/// points into a right hand's palm and out of a left hand's back: no matter, as only the turn between two of
/// one hand is asked for.
Quaternion axes_by_bones(const Hand& hand) {
  const int index = capsule_index(1, 1), little = capsule_index(4, 1);
  if (!hand.has(index) || !hand.has(little)) return hand.palm.orientation;
  const Vector3 a = hand.capsules[static_cast<std::size_t>(index)].start - hand.wrist;
  const Vector3 b = hand.capsules[static_cast<std::size_t>(little)].start - hand.wrist;
  const Vector3 out = a.cross(b);
  if (out.norm() < kFlatPalm) return hand.palm.orientation;
  Matrix3 axes;
  axes.col(0) = (a + b).normalized();
  axes.col(2) = out.normalized();
  axes.col(1) = axes.col(2).cross(axes.col(0));
  return Quaternion(axes);
}

}  // namespace

/// With this lag, how far joints' limits keep phalanges from where they were shown, all fingers together [m].
double HandRenderer::Impl::held_by_limits(const ClearanceFinder::Setting& setting, const PalmLag& lag) {
  chain.begin(setting.tracked, lag);
  double held = 0.0;
  for (int f = 0; f < kFingers; ++f) {
    const FingerChain& finger = chain.finger(f);
    const FingerOffset wanted = finger.pointing(before, finger_before(f));
    held += finger.way(wanted - wanted.max(finger.lower()).min(finger.upper()));
  }
  return held;
}

/// The palm's axes are not turned from how they were shown. frame whole R_tracked = R_before.
Quaternion HandRenderer::Impl::frame_staying(const ClearanceFinder::Setting& setting,
                                             const Quaternion& whole) const {
  return (before.palm.orientation * (whole * setting.tracked.palm.orientation).conjugate()).normalized();
}

/// The palm's bones are not turned from how they were shown; its axes, to which joints' limits count, such
/// that the fingers can stay too, as far as there are such. Compass search: a turn about each axis of world
/// either way, as long as it is better, then half the turn. What limits hold has kinks, so that no derivative
/// is asked for.
PalmLag HandRenderer::Impl::lag_staying(const ClearanceFinder::Setting& setting) {
  PalmLag lag;
  lag.whole = (axes_by_bones(before) * axes_by_bones(setting.tracked).conjugate()).normalized();
  double held = held_by_limits(setting, lag);
  const auto try_frame = [&](const Quaternion& frame) {
    const PalmLag other{lag.whole, frame.normalized()};
    const double then = held_by_limits(setting, other);
    if (then >= held) return false;
    held = then, lag = other;
    return true;
  };
  try_frame(frame_staying(setting, lag.whole));
  for (double turn = kFirstTurn; turn > kLastTurn && held > kHeld; turn *= 0.5) {
    for (int direction = 0; direction < 6; ++direction) {
      const Vector3 axis = (direction < 3 ? 1.0 : -1.0) * Vector3::Unit(direction % 3);
      while (held > kHeld && try_frame(Quaternion(Eigen::AngleAxisd(turn, axis)) * lag.frame)) {
      }
    }
  }
  return lag;
}

}  // namespace mrhi
