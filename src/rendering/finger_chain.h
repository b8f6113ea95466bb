#pragma once

#include "mr_hand_interaction/rendering/hand_offset.h"

namespace mrhi {

/// How far joints go, active and passive, rounded outwards to 5 degrees: Kapandji, The Physiology of the
/// Joints, vol. 1; Norkin & White, Measurement of Joint Motion [rad]. Order as in FingerOffset.
struct JointLimits {
  FingerOffset lower, upper;
};

/// Of the thumb: its carpometacarpal joint against a rest pose, then metacarpophalangeal and interphalangeal.
JointLimits joint_limits(int finger);

/// Rest pose of the thumb's metacarpal in the palm of a right hand (x to the fingers, z out of the back):
/// where it points, and the axis about which the thumb flexes. Unit, at right angles.
struct ThumbRest {
  Vector3 along, hinge;
};
const ThumbRest& thumb_rest();

/// The hand with its palm lagging behind. Writes to `turned`.
void turn_palm(const Hand& tracked, const PalmLag& lag, Hand& turned);

/// A tracked finger as a chain: a root joint that flexes and abducts, fixed to the palm, and two hinges.
/// Joints are turned from where they were tracked, so that bones keep their lengths whatever the offset. All
/// in world.
///
/// Axes are lines fixed to bones: root_ stays with the palm, swing_ is turned by the root's flexion, hinge_
/// by both. Angles are signed by the right-hand rule about them.
class FingerChain {
 public:
  FingerChain() = default;
  /// As placed with no offset of its own. Where the palm lags, `lags_behind` is the hand as it was tracked.
  FingerChain(const Hand& tracked, int finger, const Vector3& shift, const Hand* lags_behind = nullptr);

  /// Places the finger's phalanges, its joints turned by `offset` and all shifted by `shift`.
  void place(const Hand& tracked, const FingerOffset& offset, const Vector3& shift, Hand& placed);
  /// The offset that lets the finger point as it does in `shown`, which `chain` placed, as far as its limits
  /// allow. Of a finger that nothing ties to the palm: none.
  FingerOffset like(const Hand& shown, const FingerChain& chain) const;
  /// The same without regard to limits.
  FingerOffset pointing(const Hand& shown, const FingerChain& chain) const;
  /// By how much n.x grows with each component of the offset, x a point of bone 1 to 3 as last placed.
  FingerOffset gradient(int bone, const Vector3& x, const Vector3& n) const;
  /// No joint of the finger moves farther than this for a change of the offset [m].
  double way(const FingerOffset& change) const;

  /// How far each joint may turn while the tip moves about as far as `way` [m].
  FingerOffset swing(double way) const;

  /// Offsets that leave every joint in its limits or, if it was tracked beyond one, let it go no farther. 0
  /// is among them unless the palm lags.
  const FingerOffset& lower() const { return lower_; }
  const FingerOffset& upper() const { return upper_; }
  /// How readily each component gives way.
  FingerOffset compliance() const;

 private:
  void find_axes(const Hand& tracked);
  void find_limits(const Hand& tracked, const Hand* lags_behind);
  FingerOffset angles(const Hand& hand, const Vector3& hinge) const;
  bool has(const Hand& hand, int bone) const { return hand.has(capsule_index(finger_, bone)); }

  int finger_ = 0;
  bool tied_ = false;                            // to the palm: it has a proximal phalanx
  Vector3 onward_;                               // from where the root's angles count; unit
  Vector3 root_, swing_, hinge_;                 // axes of root flexion, abduction and the hinges; unit
  Vector3 placed_swing_, placed_hinge_;          // the same as last placed
  std::array<Vector3, kBonesPerFinger> joints_;  // start of each bone as last placed
  FingerOffset lower_, upper_;                   // see lower()
  FingerOffset reach_;                           // from each joint to the tip [m]
  FingerOffset angles_;                          // of the joints as tracked [rad]
};

/// How readily the whole hand gives way, beside its joints (FingerChain::compliance).
constexpr double kShiftCompliance = 0.3;

/// A tracked hand as a palm, which can be shifted, and five fingers on it. A finger's chain is made once it
/// is asked for: most of them touch nothing.
class HandChain {
 public:
  /// Keeps a reference.
  void begin(const Hand& tracked, const PalmLag& lag = PalmLag());

  /// The hand with its offset, which keeps within limits from here on.
  void place(const HandOffset& offset, Hand& placed);
  /// A finger, as last placed.
  FingerChain& finger(int index);

  /// Where a capsule moves by itself: its finger, or none if it moves with the palm.
  static int finger_that_moves(int capsule) {
    return capsule == kPalm || bone_of(capsule) == 0 ? -1 : finger_of(capsule);
  }

 private:
  const Hand* tracked_ = nullptr;
  const Hand* lags_behind_ = nullptr;
  Hand turned_;                      // what tracked_ is where the palm lags
  Vector3 shift_ = Vector3::Zero();  // as last placed
  std::array<FingerChain, kFingers> fingers_;
  std::array<bool, kFingers> known_{};
};

}  // namespace mrhi
