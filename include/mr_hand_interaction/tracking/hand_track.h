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
  std::array<double, kMaxFilterWindow> elapsed{};  ///< since the sample before [s]; 0 of a first one
  int size = 0;

  /// Adds `sample`, taken `since` seconds after the previous one, at the front, and keeps the newest `keep`.
  void push(const Hand& sample, double since, int keep);
};

/// The points of a hand by number: palm, wrist, then start and end of every capsule.
constexpr std::size_t kHandPoints = 2 + 2 * kCapsules;
Vector3& hand_point(Hand& hand, std::size_t point);
const Vector3& hand_point(const Hand& hand, std::size_t point);
bool has_point(const Hand& hand, std::size_t point);

/// Velocity of a hand, in world.
struct HandVelocity {
  std::array<Vector3, kHandPoints> points;  ///< [m/s]
  Vector3 turn = Vector3::Zero();           ///< of the palm [rad/s]

  HandVelocity() { points.fill(Vector3::Zero()); }
};

/// Root mean square over the points of the capsules that `hand` has [m/s].
double rms_speed(const HandVelocity& velocity, const Hand& hand);

/// Error of an estimate, the same for every point and axis: variances of position and speed, and their
/// covariance.
struct MotionVariance {
  double position = 0.0;  ///< [m^2]
  double mixed = 0.0;     ///< [m^2/s]
  double speed = 0.0;     ///< [m^2/s^2]; 0: no estimate yet
};

/// Observed noise of a tracker's samples of one hand: variances on an axis.
struct SeenNoise {
  std::array<double, kNoiseWindow> variances{};  ///< one for each of the last samples, newest first [m^2]
  int size = 0;                                  ///< number of variances
  double variance = 0.0;                         ///< the estimate [m^2]; 0: too few samples yet
};

/// Memory of a filter for one hand; each filter uses the part that it needs.
struct FilterMemory {
  SampleHistory history;
  Hand filtered;            ///< the last result
  HandVelocity velocity;    ///< one_euro: of the samples, smoothed; constant_velocity: of `filtered`
  MotionVariance variance;  ///< constant_velocity
  SeenNoise noise;          ///< constant_velocity: of the tracker, so it outlasts restart() and clear()

  bool empty() const { return history.size == 0; }
  void clear() { history.size = 0; }
  /// Resets the memory: the hand appears with `sample`.
  void restart(const Hand& sample);
};

constexpr int kMaxHands = 4;            ///< followed at once
constexpr double kMeanVelocity = 0.03;  ///< time constant of HandTrack::mean_velocity [s]

/// Return of a hand after a short loss: it catches up from its held pose to the tracked hand, with continuous
/// velocity and never ahead of it.
struct Rejoin {
  Hand from;                 ///< pose that was held
  Nanoseconds begin = 0;     ///< stamp of the first frame after the loss
  Nanoseconds duration = 0;  ///< 0: not catching up
};

/// Transition from one filter to another, in which the hand moves from the pose of the one to that of the
/// other.
struct FilterChange {
  FilterConfiguration from;
  FilterMemory memory;  ///< of the old filter, which continues meanwhile
  Nanoseconds begin = 0;
};

/// The path of a hand's points between two frames: a cubic whose velocity is continuous from frame to frame,
/// so that a held body gets no impact at every frame. With f the fraction of the frame, D the chord from
/// the first pose to the second and b, e the bends,
///     p(f) = p(0) + f D + f (1 - f)^2 b - f^2 (1 - f) e,     T p'(0) = D + b,     T p'(1) = D + e
/// which is Hermite's. Without bends a point moves on a straight line at constant speed.
struct HandPath {
  HandVelocity start_bend, end_bend;  ///< b and e [m], of the palm's turn [rad]
  double longest_bend = 0.0;          ///< limit of all points, at either frame [m]
  HandVelocity velocity;              ///< at the second frame
  /// Newton's backward divided differences of the poses, of order 1 to 3, at the second frame [m/s^order].
  std::array<HandVelocity, 3> differences;
  std::array<double, 3> intervals{};  ///< of the last frames, newest first [s]
  int order = 0;                      ///< number of differences that are known
  /// Energies of the fourth differences and of the extrapolated part: means over the last frames [m^2/s^2].
  double noise = 0.0, energy = 0.0;
  double extrapolated = 0.0;  ///< part of `velocity` beyond the chord's, fastest point [m/s]
};

/// Weights of the chord and of both bends in a displacement along a HandPath, or in a velocity [1/s].
struct PathWeights {
  double chord, start_bend, end_bend;

  static PathWeights at(double f) { return {f, f * (1.0 - f) * (1.0 - f), -f * f * (1.0 - f)}; }
  /// Mean velocity from one fraction of a frame of `seconds` to another; at a single fraction the velocity.
  static PathWeights between(double from, double to, double seconds);
  Vector3 operator()(const Vector3& d, const Vector3& b, const Vector3& e) const {
    return chord * d + start_bend * b + end_bend * e;
  }
};

/// One hand followed through time.
struct HandTrack {
  bool active = false;    ///< false: this slot is free
  bool held = false;      ///< missing in the last frame: keeps its pose until hold_time is over
  bool appeared = false;  ///< new at the last frame, or jumped there
  bool emerged = false;  ///< appeared at the previous frame: what it overlaps as it begins to move is ignored
  Hand previous;         ///< filtered pose at the previous frame
  Hand current;          ///< filtered pose at the last frame
  Nanoseconds last_seen = 0;
  FilterMemory filter;
  Rejoin rejoin;
  std::optional<FilterChange> filter_change;
  HandPath path;               ///< from `previous` to `current`
  HandVelocity mean_velocity;  ///< of the last frames, exponential mean over kMeanVelocity
};

/// Continues the path of the track to its current pose, `elapsed` seconds (above 0) after the previous one.
///
/// The velocity at the new frame is the derivative of the polynomial through the last five poses. Its
/// difference from the chord's velocity is reduced by the fraction of noise in it, which the fourth
/// differences show, by one factor for the whole hand: noisy samples are joined smoothly, and not
/// extrapolated. The path overshoots a sudden stop by at most kMaxOvershoot.
void extend_path(double elapsed, HandTrack& track);

/// Time for catching up with a hand that has moved by `way` [m] in the `away` seconds of its loss and keeps
/// that speed: limits the acceleration to 5 m/s^2, from 0.05 to 0.4 s.
Nanoseconds rejoin_duration(double way, double away);

/// The hand at `stamp` between its held pose and the tracked hand (minimum jerk: Flash & Hogan 1985).
Hand catching_up(const Rejoin& rejoin, const Hand& tracked, Nanoseconds stamp);

/// Largest distance between the places of a joint that both hands have [m].
double farthest_joint(const Hand& from, const Hand& to);

/// Interpolates between two poses of one hand: all points move on straight lines.
Hand blend(const Hand& from, const Hand& to, double fraction);

}  // namespace mrhi
