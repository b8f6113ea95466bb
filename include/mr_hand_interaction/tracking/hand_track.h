#pragma once

#include <array>
#include <optional>

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

constexpr int kMaxFilterWindow = 16;  ///< frames
constexpr int kNoiseWindow = 16;      ///< samples from which a tracker's noise is estimated

/// The last raw samples of one hand, newest first.
struct SampleHistory {
  std::array<Hand, kMaxFilterWindow> samples;
  std::array<double, kMaxFilterWindow> elapsed{};  ///< since the previous sample [s]; 0 for the first
  int size = 0;

  /// Adds `sample`, taken `since` seconds after the previous one, and keeps only the newest `keep`.
  void push(const Hand& sample, double since, int keep);
};

/// Numbered points of a hand: palm, wrist, then start and end of every capsule.
constexpr std::size_t kHandPoints = 2 + 2 * kCapsules;
Vector3& hand_point(Hand& hand, std::size_t point);
const Vector3& hand_point(const Hand& hand, std::size_t point);
bool has_point(const Hand& hand, std::size_t point);

/// Velocity of a hand, in world.
struct HandVelocity {
  std::array<Vector3, kHandPoints> points;  ///< [m/s]
  Vector3 turn = Vector3::Zero();           ///< angular velocity of the palm [rad/s]

  HandVelocity() { points.fill(Vector3::Zero()); }
};

/// Root mean square over the points of the capsules that `hand` has [m/s].
double rms_speed(const HandVelocity& velocity, const Hand& hand);

/// Covariance of an estimate, the same for every point and axis.
struct MotionVariance {
  double position = 0.0;  ///< [m^2]
  double mixed = 0.0;     ///< [m^2/s]
  double speed = 0.0;     ///< [m^2/s^2]; 0: no estimate yet
};

/// Estimated noise of a tracker's samples of one hand: variances on an axis.
struct SeenNoise {
  std::array<double, kNoiseWindow> variances{};  ///< one for each of the last samples, newest first [m^2]
  int size = 0;                                  ///< number of valid entries
  double variance = 0.0;                         ///< estimate [m^2]; 0: too few samples
};

/// A filter's state for one hand; each filter uses a part of it.
struct FilterMemory {
  SampleHistory history;
  Hand filtered;            ///< the last result
  HandVelocity velocity;    ///< one_euro: of the samples, smoothed; constant_velocity: of `filtered`
  MotionVariance variance;  ///< constant_velocity
  SeenNoise noise;          ///< constant_velocity: of the tracker, so restart() and clear() keep it

  bool empty() const { return history.size == 0; }
  void clear() { history.size = 0; }
  /// Discards earlier samples: the hand is re-acquired with `sample`.
  void restart(const Hand& sample);
};

constexpr int kMaxHands = 4;            ///< tracked simultaneously
constexpr double kMeanVelocity = 0.03;  ///< time constant of HandTrack::mean_velocity [s]

/// After a short loss the rendered hand does not jump from its held pose to the tracked one. It catches up,
/// with continuous velocity and never ahead of the tracked hand.
struct Rejoin {
  Hand from;                 ///< held pose
  Nanoseconds begin = 0;     ///< stamp of the first frame after the loss
  Nanoseconds duration = 0;  ///< 0: not catching up
};

/// Cross-fade of the hand's pose from one filter to another.
struct FilterChange {
  FilterConfiguration from;
  FilterMemory memory;  ///< of the old filter, which runs on during the change
  Nanoseconds begin = 0;
};

/// Path of a hand's points between two frames: a cubic with continuous velocity from frame to frame, so that
/// a held body is not hit anew at every frame. With f the fraction of the frame, D the chord from the first
/// pose to the second and b, e the bends,
///     p(f) = p(0) + f D + f (1 - f)^2 b - f^2 (1 - f) e,     T p'(0) = D + b,     T p'(1) = D + e
/// This is Hermite's cubic. Without bends a point moves on a straight line at constant speed.
struct HandPath {
  HandVelocity start_bend, end_bend;  ///< b and e [m]; of the palm's rotation [rad]
  double longest_bend = 0.0;          ///< over all points, at either frame [m]
  HandVelocity velocity;              ///< at the second frame, at the end of the path
  /// Newton's backward divided differences of the poses, of order 1 to 3, at the second frame [m/s^order].
  std::array<HandVelocity, 3> differences;
  std::array<double, 3> intervals{};  ///< of the last frames, newest first [s]
  int order = 0;                      ///< number of valid differences
  /// Means over the last frames of the fourth differences, and of all extrapolated terms [m^2/s^2].
  double noise = 0.0, energy = 0.0;
  double extrapolated = 0.0;  ///< largest extrapolated part of `velocity` over the points [m/s]
};

/// Weights of the chord and of both bends in a displacement along a HandPath, or in a velocity [1/s].
struct PathWeights {
  double chord, start_bend, end_bend;

  static PathWeights at(double f) { return {f, f * (1.0 - f) * (1.0 - f), -f * f * (1.0 - f)}; }
  /// Mean velocity between two fractions of a frame of `seconds`; the velocity if they are equal.
  static PathWeights between(double from, double to, double seconds);
  Vector3 operator()(const Vector3& d, const Vector3& b, const Vector3& e) const {
    return chord * d + start_bend * b + end_bend * e;
  }
};

/// State of one tracked hand.
struct HandTrack {
  bool active = false;     ///< false: this slot is unused
  bool held = false;       ///< missing in the last frame: coasts to rest, and keeps its pose for hold_time
  bool appeared = false;   ///< re-acquired at the last frame, or jumped there
  bool emerged = false;    ///< re-acquired at the frame before: overlaps at its first motion are ignored
  bool converges = false;  ///< returned while it coasted: `current` converges to the filtered pose
  Hand previous;           ///< filtered pose at the previous frame
  Hand current;            ///< filtered pose at the last frame
  Nanoseconds last_seen = 0;
  FilterMemory filter;
  Rejoin rejoin;
  std::optional<FilterChange> filter_change;
  HandPath path;               ///< from `previous` to `current`
  HandVelocity mean_velocity;  ///< exponential mean over kMeanVelocity
};

/// Extends the path of the track to its current pose, `elapsed` seconds (above 0) after the previous one.
///
/// The velocity at the new frame is the derivative of the polynomial through the last five poses. Its excess
/// over the chord's velocity is scaled down by the noise ratio of the fourth differences, by one factor for
/// the whole hand. So noisy samples are joined smoothly, but not extrapolated. After a sudden stop the path
/// overshoots by at most kMaxOvershoot.
void extend_path(double elapsed, HandTrack& track);

/// Duration in which a hand catches up with one that is `distance` [m] ahead and moves at `speed` [m/s]. It
/// limits the acceleration to 5 m/s^2, within 0.05 to 0.4 s.
Nanoseconds rejoin_duration(double distance, double speed);

/// The hand at `stamp` between its held pose and the tracked hand (minimum jerk: Flash & Hogan 1985).
Hand catching_up(const Rejoin& rejoin, const Hand& tracked, Nanoseconds stamp);

/// Largest distance between corresponding joints of both hands [m].
double farthest_joint(const Hand& from, const Hand& to);

/// Interpolated pose of a hand: all points move on straight lines.
Hand blend(const Hand& from, const Hand& to, double fraction);

}  // namespace mrhi
