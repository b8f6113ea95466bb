#pragma once

#include <Eigen/Core>
#include <array>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// Rotation of a finger's joints from where they were tracked: flexion (towards the palm) and
/// abduction (towards the thumb of a right hand) of its root, flexion of its middle and end joint [rad]. For
/// a finger without a proximal phalanx, which is not connected to the palm: its shift in world [m], and 0.
using FingerOffset = Eigen::Array4d;

/// Rotation of the rendered palm from the tracked one, where tracking turns it faster than the rendered hand
/// may turn. Joints keep their angles in the palm.
struct PalmLag {
  Quaternion whole = Quaternion::Identity();  ///< of all the hand, about the palm's position
  Quaternion frame = Quaternion::Identity();  ///< then of the palm's axes alone, metacarpals staying
  bool zero() const { return whole.vec() == Vector3::Zero() && frame.vec() == Vector3::Zero(); }
};

/// Difference of a rendered hand from the tracked one. Lasts from frame to frame.
struct HandOffset {
  Vector3 shift = Vector3::Zero();  ///< of the whole hand in world [m]
  std::array<FingerOffset, kFingers> fingers;
  PalmLag lag;
  Nanoseconds stamp = 0;  ///< of the frame that it was found for

  // While a body holds the rendered hand back and the tracked hand is clear of all bodies:
  double left = 0.0;           ///< smallest distance to the tracked hand so far [m]; 0: not held back
  Nanoseconds left_since = 0;  ///< when that was

  HandOffset() { fingers.fill(FingerOffset::Zero()); }
  bool zero() const;
};

/// Lag of the rendered hand behind the tracked hand due to the mass that it accelerates
/// (Configuration::control_display_ratio). Lasts from frame to frame.
struct MassLag {
  Vector3 displacement = Vector3::Zero();  ///< of the rendered hand from the tracked one, world [m]
  Vector3 velocity = Vector3::Zero();      ///< of the displacement [m/s]
  Nanoseconds stamp = 0;                   ///< of the frame that it was found for; 0: none yet
  bool zero() const { return displacement == Vector3::Zero() && velocity == Vector3::Zero(); }
};

/// Load of a phalanx or the palm, over all its contacts.
struct Pressed {
  double force = 0.0;               ///< size of the normal forces' sum [N]
  Vector3 point = Vector3::Zero();  ///< centre of its contacts, world [m]
};

/// One hand as rendered: outside every object.
struct RenderedHand {
  Hand hand;
  std::array<bool, kCapsules> touching{};
  std::array<Pressed, kCapsules> pressed{};  ///< of those that touch
};

}  // namespace mrhi
