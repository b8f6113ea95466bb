#pragma once

#include <array>

#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

/// The capsules of one hand through a frame: all points move on straight lines at constant speed.
struct MovingHand {
  int slot = 0;          ///< of the track
  bool emerged = false;  ///< this is its first step since it appeared: what it overlaps is ignored
  std::array<Capsule, kCapsules> capsules;        ///< at the step's start
  std::array<Vector3, kCapsules> start_velocity;  ///< [m/s]
  std::array<Vector3, kCapsules> end_velocity;    ///< [m/s]
  std::array<double, kCapsules> speed{};          ///< of the faster end [m/s]
  double top_speed = 0.0;                         ///< of the fastest [m/s]
  Matrix3 palm = Matrix3::Identity();             ///< orientation
  Vector3 palm_spin = Vector3::Zero();            ///< angular velocity of the palm [rad/s]

  /// Velocity of the surface point axis_point(s) + offset of a capsule (Eq. 7 for a segment; spin about the
  /// capsule's own axis is not observed) [m/s].
  Vector3 surface_velocity(int capsule, double s, const Vector3& offset) const;
};

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
  std::array<Capsule, kCapsules> from_;
  double seconds_;
  bool emerged_;
  Matrix3 palm_from_;
  Eigen::AngleAxisd palm_turn_;
};

}  // namespace mrhi
