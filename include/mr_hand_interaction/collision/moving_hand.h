#pragma once

#include <array>

#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

/// The capsules of one hand in one step: where they are at its start, and how fast their ends move through
/// it.
struct MovingHand {
  int slot = 0;          ///< of the track
  bool emerged = false;  ///< this is its first step since it appeared: what it overlaps is ignored
  std::array<Capsule, kCapsules> capsules;
  std::array<Vector3, kCapsules> start_velocity;  ///< [m/s]
  std::array<Vector3, kCapsules> end_velocity;    ///< [m/s]
  Quaternion palm = Quaternion::Identity();       ///< orientation
  Vector3 palm_spin = Vector3::Zero();            ///< angular velocity of the palm [rad/s]

  /// Velocity of the surface point axis_point(s) + offset of a capsule (Eq. 7 for a segment; spin about the
  /// capsule's own axis is not observed) [m/s].
  Vector3 surface_velocity(int capsule, double s, const Vector3& offset) const;

  /// Angular velocity of a phalanx: across its axis from its ends, about its axis from the palm [rad/s].
  Vector3 angular_velocity(int capsule) const;
};

/// The hand of `track` at `fraction` of the frame that lasts `seconds`.
MovingHand moving_hand(const HandTrack& track, int slot, double fraction, double seconds);

}  // namespace mrhi
