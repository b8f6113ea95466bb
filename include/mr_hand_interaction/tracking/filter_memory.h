#pragma once

#include <array>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

constexpr int kMaxFilterWindow = 16;  ///< frames

/// The last raw samples of one hand, newest first.
struct SampleHistory {
  std::array<Hand, kMaxFilterWindow> samples;
  int size = 0;

  /// Puts `sample` in front and forgets all but the newest `keep`.
  void push(const Hand& sample, int keep);
};

/// The points of a hand by number: palm, wrist, then start and end of every capsule.
constexpr std::size_t kHandPoints = 2 + 2 * kCapsules;
Vector3& hand_point(Hand& hand, std::size_t point);
const Vector3& hand_point(const Hand& hand, std::size_t point);
bool has_point(const Hand& hand, std::size_t point);

/// How a hand moves, in world.
struct HandVelocity {
  std::array<Vector3, kHandPoints> points;  ///< [m/s]
  Vector3 turn = Vector3::Zero();           ///< of the palm [rad/s]

  HandVelocity() { points.fill(Vector3::Zero()); }
};

/// How far an estimate may be off, the same for every point and axis: variances of position and speed, and
/// their covariance.
struct MotionVariance {
  double position = 0.0;  ///< [m^2]
  double mixed = 0.0;     ///< [m^2/s]
  double speed = 0.0;     ///< [m^2/s^2]; 0: no estimate yet
};

/// What a filter remembers of one hand; each uses the part that it needs.
struct FilterMemory {
  SampleHistory history;
  Hand filtered;            ///< the last result
  HandVelocity velocity;    ///< one_euro: of the samples, smoothed; constant_velocity: of `filtered`
  MotionVariance variance;  ///< constant_velocity

  bool empty() const { return history.size == 0; }
  void clear() { history.size = 0; }
  /// What was before is forgotten: the hand appears with `sample`.
  void restart(const Hand& sample);
};

}  // namespace mrhi
