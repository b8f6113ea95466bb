#pragma once

#include <array>
#include <cstdint>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

constexpr int kGripPoints = 4;  ///< springs of a grip, at the corners of a tetrahedron

/// Start and end of each finger's distal phalanx [m].
using DistalEnds = std::array<Vector3, 2 * kFingers>;

/// A hand that has closed round a body, and through it, holds the body: by springs between the hand and the
/// body that yield beyond what the hand's friction could bear. They give no force as the grip begins.
struct Grip {
  std::uint16_t body = 0;                      ///< index in Scene::bodies
  std::uint8_t hand = 0;                       ///< index of the hand's track
  bool by_palm = false;                        ///< what the fingers close against: the palm, or the thumb
  std::uint8_t fingers = 0;                    ///< those that close, a bit each
  double opening = 0.0;                        ///< at which both sides just touch the body [m]
  double least = 0.0;                          ///< of the opening since the grip began [m]
  double bond = 0.0;                           ///< most that each spring bears [N]
  double stiffness = 0.0;                      ///< of each spring [N/m]
  bool bears = false;                          ///< contact alone has not held the body
  bool fresh = false;                          ///< it begins to bear in this step
  bool closes = true;                          ///< the hand still closes
  DistalEnds pads{};                           ///< when it took, palm frame [m]
  bool placed = false;                         ///< the next two are those of this frame
  Pose in_palm_before;                         ///< what the palm's frame was then, as the frame begins
  Pose in_palm;                                ///< and as it ends; fingers that open do not move it
  bool slips = false;                          ///< it has yielded in the last step
  std::array<Vector3, kGripPoints> in_hand{};  ///< the springs' ends, palm frame when it took [m]
  std::array<Vector3, kGripPoints> in_body{};  ///< and the others, body frame [m]
  Vector3 force = Vector3::Zero();             ///< on the body in the last step, world [N]

  // In this step, world.
  std::array<Vector3, kGripPoints> point{};     ///< the ends on the hand, at the step's start [m]
  std::array<Vector3, kGripPoints> velocity{};  ///< and theirs [m/s]

  bool takes_part(int finger) const { return (fingers >> finger & 1) != 0; }
};

/// The tip of a finger, world [m].
Vector3 tip_of(const Hand& hand, int finger);
/// What fingers close against: the middle of the palm, or the thumb's tip, world [m].
Vector3 base_of(const Hand& hand, bool by_palm);
/// Distance between the tips of the grip's fingers, in the mean, and what they close against [m].
double opening(const Grip& grip, const Hand& hand);
/// In the palm's frame.
DistalEnds distal_ends(const Hand& hand);
/// Where what was the palm's frame when the hand took the body has gone with both sides of the grip, in the
/// palm's frame: the rigid motion that is nearest to theirs (Kabsch 1976), and a little to the palm's.
Pose moved_in_palm(const Grip& grip, const Hand& hand);

}  // namespace mrhi
