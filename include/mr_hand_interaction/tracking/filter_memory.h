#pragma once

#include <array>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

constexpr int kMaxFilterWindow = 16;  ///< frames
constexpr int kNoiseWindow = 16;      ///< samples that tell the noise of a tracker

/// The last raw samples of one hand, newest first.
struct SampleHistory {
  std::array<Hand, kMaxFilterWindow> samples;
  std::array<double, kMaxFilterWindow> elapsed{};  ///< since the sample before [s]; 0 of a first one
  int size = 0;

  /// Puts `sample`, taken `since` seconds after the one before, in front and forgets all but the newest
  /// `keep`.
  void push(const Hand& sample, double since, int keep);
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

/// Root mean square over the points of the capsules that `hand` has [m/s].
double rms_speed(const HandVelocity& velocity, const Hand& hand);

/// How far an estimate may be off, the same for every point and axis: variances of position and speed, and
/// their covariance.
struct MotionVariance {
  double position = 0.0;  ///< [m^2]
  double mixed = 0.0;     ///< [m^2/s]
  double speed = 0.0;     ///< [m^2/s^2]; 0: no estimate yet
};

/// How much a tracker's samples of one hand have been seen to tremble: variances on an axis.
struct SeenNoise {
  std::array<double, kNoiseWindow> variances{};  ///< one for each of the last samples, newest first [m^2]
  int size = 0;                                  ///< of them are there
  double variance = 0.0;                         ///< what they come to [m^2]; 0: too few yet
};

/// What a filter remembers of one hand; each uses the part that it needs.
struct FilterMemory {
  SampleHistory history;
  Hand filtered;            ///< the last result
  HandVelocity velocity;    ///< one_euro: of the samples, smoothed; constant_velocity: of `filtered`
  MotionVariance variance;  ///< constant_velocity
  SeenNoise noise;          ///< constant_velocity: of the tracker, so it outlasts restart() and clear()

  bool empty() const { return history.size == 0; }
  void clear() { history.size = 0; }
  /// What was before is forgotten: the hand appears with `sample`.
  void restart(const Hand& sample);
};

}  // namespace mrhi
