#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

constexpr int kGripPoints = 4;  ///< springs of a grip, at the corners of a tetrahedron

/// Start and end of each finger's distal phalanx [m].
using DistalEnds = std::array<Vector3, 2 * kFingers>;

/// A hand that has a body between its fingers and its thumb or palm. While it is active, springs between hand
/// and body support what the contacts lack. Each spring yields at its bond, and starts without force.
struct Grip {
  std::uint16_t body = 0;           ///< index in Scene::bodies
  std::uint8_t hand = 0;            ///< index of the hand's track
  bool by_palm = false;             ///< the fingers close against the palm; false: against the thumb
  std::uint8_t fingers = 0;         ///< those that close, a bit each
  double touch_aperture = 0.0;      ///< aperture at which both sides just touch the body [m]
  double mean_aperture = 0.0;       ///< exponential mean over kMeanAperture [m]
  double min_aperture = 0.0;        ///< smallest since the grip began, without the tracker's noise [m]
  double bond = 0.0;                ///< largest force of each spring [N]
  double stiffness = 0.0;           ///< of each spring [N/m]
  bool active = false;              ///< the springs act: the contacts alone did not hold the body
  bool released = false;            ///< the hand has let go: no force on the body until it has left it
  std::optional<Nanoseconds> lost;  ///< stamp at which the hand was last seen: the grip waits for its return
  Pose body_in_palm;                ///< then
  bool closes = true;               ///< the hand is still closing
  double opened = 0.0;              ///< by how much the hand has opened since it was most closed [m]
  bool opens = false;               ///< the hand is opening: the grip does not follow its fingers
  DistalEnds pads{};                ///< as the grip began, palm frame [m]
  Pose in_palm_before;  ///< at the frame's start: where the palm's frame of that time is now, in the palm
  Pose in_palm;         ///< the same at the frame's end
  bool slips = false;   ///< a spring yielded in the last step
  std::array<Vector3, kGripPoints> in_hand{};  ///< ends of the springs, palm frame as the grip began [m]
  std::array<Vector3, kGripPoints> in_body{};  ///< the other ends, body frame [m]
  Vector3 force = Vector3::Zero();             ///< on the body in the last step, world [N]
  Vector3 torque = Vector3::Zero();            ///< likewise, about its centre of mass [N m]

  // In this step, world.
  std::array<Vector3, kGripPoints> point{};     ///< the ends on the hand, at the step's start [m]
  std::array<Vector3, kGripPoints> velocity{};  ///< of these ends [m/s]

  bool takes_part(int finger) const { return (fingers >> finger & 1) != 0; }
};

/// Index of the point of HandVelocity that is a finger's tip.
std::size_t tip_point(int finger);
/// The tip of a finger, world [m].
Vector3 tip_of(const Hand& hand, int finger);
/// What fingers close against: the palm's origin, or the thumb's tip, world [m].
Vector3 base_of(const Hand& hand, bool by_palm);
/// Distance from the mean tip of the grip's fingers to the base [m].
double aperture(const Grip& grip, const Hand& hand);
/// In the palm's frame.
DistalEnds distal_ends(const Hand& hand);
/// How both sides of the grip have moved in the palm since it began: the rigid motion nearest to that of the
/// pads (Kabsch 1976), and a little to the palm's.
Pose moved_in_palm(const Grip& grip, const Hand& hand);

}  // namespace mrhi
