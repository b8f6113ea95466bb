#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

constexpr int kGripPoints = 4;  ///< springs of a grip, at the corners of a tetrahedron

/// Start and end of each finger's distal phalanx [m].
using DistalEnds = std::array<Vector3, 2 * kFingers>;

/// A grasp-assist constraint between a hand and a body between its fingers and its thumb or palm. While
/// active, springs between hand and body supply the forces that contacts lack. Each spring yields at its
/// bond, and starts without force.
struct Grip {
  std::uint16_t body = 0;           ///< index in Scene::bodies
  std::uint8_t hand = 0;            ///< index of the hand's track
  bool by_palm = false;             ///< the fingers close against the palm; false: against the thumb
  std::uint8_t fingers = 0;         ///< bit mask of the closing fingers
  double touch_aperture = 0.0;      ///< aperture at which both opposing groups just touch [m]
  double mean_aperture = 0.0;       ///< exponential mean over kMeanAperture [m]
  double min_aperture = 0.0;        ///< smallest since the grip began, corrected for tracking noise [m]
  double bond = 0.0;                ///< largest force of each spring [N]
  double stiffness = 0.0;           ///< of each spring [N/m]
  bool active = false;              ///< the springs act: contacts alone did not hold the body
  bool released = false;            ///< the hand has released the body: no force until they have separated
  std::optional<Nanoseconds> lost;  ///< stamp at which the hand was last seen: the grip waits for its return
  Pose body_in_palm;                ///< at the stamp `lost`
  bool closes = true;               ///< the hand is still closing
  double opened = 0.0;              ///< increase of the aperture since its minimum [m]
  DistalEnds pads{};                ///< at the start of the grip, palm frame [m]
  Pose in_palm_before;              ///< at the start of the frame: pose of the initial palm frame in the palm
  Pose in_palm;                     ///< likewise at the end of the frame
  bool slips = false;               ///< a spring yielded in the last step
  std::array<Vector3, kGripPoints> in_hand{};  ///< ends of the springs, initial palm frame [m]
  std::array<Vector3, kGripPoints> in_body{};  ///< the other ends, body frame [m]
  Vector3 force = Vector3::Zero();             ///< on the body in the last step, world [N]
  Vector3 torque = Vector3::Zero();            ///< likewise, about its centre of mass [N m]

  // In this step, world.
  std::array<Vector3, kGripPoints> point{};     ///< the ends on the hand, at the step's start [m]
  std::array<Vector3, kGripPoints> velocity{};  ///< velocities of these ends [m/s]

  bool takes_part(int finger) const { return (fingers >> finger & 1) != 0; }
};

/// Index in HandVelocity::points of a fingertip.
std::size_t tip_point(int finger);
/// Position of a fingertip, world [m].
Vector3 tip_of(const Hand& hand, int finger);
/// Base that fingers close against: the palm's origin, or the thumb's tip, world [m].
Vector3 base_of(const Hand& hand, bool by_palm);
/// Distance from the mean fingertip of the grip to the base [m].
double aperture(const Grip& grip, const Hand& hand);
[[deprecated("use aperture")]] inline double opening(const Grip& grip, const Hand& hand) {
  return aperture(grip, hand);
}
/// Ends of the distal phalanges in the palm's frame [m].
DistalEnds distal_ends(const Hand& hand);
/// Motion of the opposing contact groups in the palm since the grip began: the rigid motion nearest to that
/// of the pads (Kabsch 1976), with a small weight of the palm's.
Pose moved_in_palm(const Grip& grip, const Hand& hand);

}  // namespace mrhi
