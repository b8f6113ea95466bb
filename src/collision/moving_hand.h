#pragma once

#include <array>

#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

/// How a phalanx moves: its ends as given, its turn about its own axis as the palm's.
///
/// The two ends' velocities v0, v1 tell five of the six numbers of a rigid motion: v1 - v0 = w x a has what
/// of w is across the axis a,
///     swing = a x (v1 - v0) / a^2,
/// as a x (w x a) = a^2 w - (a.w) a. A change of length along a drops out. The spin about a is not to be seen
/// from the ends: spin = swing + (a.w_palm) a / a^2.
struct PhalanxMotion {
  Vector3 axis;                     ///< from start to end [m]
  Vector3 velocity;                 ///< of the start [m/s]
  Vector3 spread;                   ///< of the end against the start [m/s]
  Vector3 swing = Vector3::Zero();  ///< angular velocity across the axis, as the ends tell [rad/s]
  Vector3 spin;                     ///< the same with what the palm tells about the axis [rad/s]

  /// Velocity of the surface point axis_point(s) + offset (Eq. 7 for a segment; spin about the capsule's own
  /// axis is not observed) [m/s].
  Vector3 of_surface(double s, const Vector3& offset) const {
    return velocity + s * spread + swing.cross(offset);
  }
};

/// The capsules of one hand through a frame: all points move on straight lines at constant speed. A point of
/// an axis moves by a mean of its ends' velocities, so that none is faster than the faster end.
struct MovingHand {
  int slot = 0;                                   ///< of the track
  std::array<Capsule, kCapsules> from;            ///< at the frame's start
  std::array<Vector3, kCapsules> start_velocity;  ///< [m/s]
  std::array<Vector3, kCapsules> end_velocity;    ///< [m/s]
  std::array<double, kCapsules> speed{};          ///< of the faster end [m/s]
  Vector3 palm_spin = Vector3::Zero();            ///< angular velocity of the palm [rad/s]

  // At the step's start.
  double time = 0.0;                   ///< since the frame's start [s]
  bool emerged = false;                ///< first step since the hand appeared: what it overlaps is ignored
  Matrix3 palm = Matrix3::Identity();  ///< orientation

  /// `later` [s] than the step's start.
  Capsule capsule(int c, double later = 0.0) const {
    const auto i = static_cast<std::size_t>(c);
    const double t = time + later;
    return {from[i].start + t * start_velocity[i], from[i].end + t * end_velocity[i], from[i].radius};
  }
  PhalanxMotion motion(int c, const Capsule& now) const;
};

inline PhalanxMotion MovingHand::motion(int c, const Capsule& now) const {
  const auto i = static_cast<std::size_t>(c);
  PhalanxMotion motion;
  motion.axis = now.end - now.start;
  motion.velocity = start_velocity[i];
  motion.spread = end_velocity[i] - start_velocity[i];
  motion.spin = palm_spin;
  const double length_squared = motion.axis.squaredNorm();
  if (length_squared > 0.0) {
    const double inverse = 1.0 / length_squared;
    motion.swing = inverse * motion.axis.cross(motion.spread);
    motion.spin = motion.swing + (inverse * motion.axis.dot(palm_spin)) * motion.axis;
  }
  return motion;
}

/// The hand of a track in a frame that lasts some time; made once a frame, then moved from step to step.
class HandMotion {
 public:
  /// `seconds` may be 0 for a hand that keeps still.
  HandMotion(const HandTrack& track, int slot, double seconds);

  /// Moves the hand on to `fraction` of the frame.
  void move_to(double fraction);
  const MovingHand& hand() const { return hand_; }

 private:
  MovingHand hand_;
  double seconds_;
  bool emerged_;
  Matrix3 palm_from_;
  Eigen::AngleAxisd palm_turn_;
};

}  // namespace mrhi
