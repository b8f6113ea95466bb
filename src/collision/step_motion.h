#pragma once

#include <array>
#include <optional>

#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

/// A body through one step: where it is at its start, and how it goes on if nothing touches it.
struct MovingBody {
  MovingBody(const Body& of, const BodyState& state, const Vector3& gravity);

  Pose at(double time) const;  ///< [s] from the step's start
  /// Velocity, at that time, of its point that is `arm` off its centre [m/s].
  Vector3 velocity(double time, const Vector3& arm) const;

  Vector3 to_world(const Vector3& local) const { return rotation * local + pose.position; }
  Vector3 to_local(const Vector3& world) const { return rotation.transpose() * (world - pose.position); }
  Capsule to_local(const Capsule& world) const {
    return {to_local(world.start), to_local(world.end), world.radius};
  }

  const Body& body;
  const Pose& pose;      ///< at the step's start
  Matrix3 rotation;      ///< of that pose
  Twist twist;           ///< at the step's start
  Vector3 acceleration;  ///< zero for a fixture [m/s^2]
  bool appeared;         ///< as this step began
};

/// Motion of a phalanx by the velocities v0, v1 of its ends. v1 - v0 = w x a gives the angular velocity
/// across the axis a, swing = a x (v1 - v0) / a^2. About the axis it is the palm's: spin = swing + (a.w_palm)
/// a / a^2.
struct PhalanxMotion {
  Vector3 axis;                     ///< from start to end [m]
  Vector3 velocity;                 ///< of the start [m/s]
  Vector3 spread;                   ///< of the end against the start [m/s]
  Vector3 swing = Vector3::Zero();  ///< angular velocity across the axis [rad/s]
  Vector3 spin;                     ///< the same with that about the axis [rad/s]

  /// Velocity of the surface point axis_point(s) + offset, without spin about the axis (Eq. 7) [m/s].
  Vector3 of_surface(double s, const Vector3& offset) const {
    return velocity + s * spread + swing.cross(offset);
  }
};

/// The frame in which an operator's hands are tracked, as it moves at a step's start.
struct CarrierMotion {
  Matrix3 rotation;  ///< of the frame in world
  Vector3 origin;    ///< of the frame [m]
  Vector3 centre;    ///< of the operator's mass [m]
  Twist twist;       ///< of that centre, world axes

  Vector3 to_world(const Vector3& local) const { return rotation * local + origin; }
  /// Velocity of a point that moves with the frame [m/s].
  Vector3 velocity(const Vector3& point) const { return twist.linear + twist.angular.cross(point - centre); }
  /// Turns velocities of a phalanx in the frame, whose start is at `point`, into those in world.
  void carry(const Vector3& point, PhalanxMotion& motion) const;
};

/// The path of one end of a capsule through a frame; see HandPath [m].
struct EndPath {
  Vector3 from, chord, start_bend, end_bend;

  Vector3 displacement(const PathWeights& weights) const { return weights(chord, start_bend, end_bend); }
};

/// The capsules of one hand through a frame. Their ends follow a HandPath from step to step, and the chord of
/// that path within a step.
struct MovingHand {
  int slot = 0;                          ///< of the track
  std::array<EndPath, kCapsules> start;  ///< of each capsule
  std::array<EndPath, kCapsules> end;
  std::array<double, kCapsules> radius{};  ///< [m]
  std::array<double, kCapsules> speed{};   ///< limit of the faster end in the frame [m/s]

  // At the step's start.
  PathWeights place{};                  ///< displacement since the frame's start
  PathWeights rate{};                   ///< mean velocity in the step [1/s]
  bool spawned = false;                 ///< first step of the hand: contacts of overlaps are ignored
  Matrix3 palm = Matrix3::Identity();   ///< orientation
  Vector3 palm_spin = Vector3::Zero();  ///< angular velocity of the palm [rad/s]

  const CarrierMotion* carrier = nullptr;  ///< what the paths are in; null: world

  /// At the step's start.
  Capsule capsule(int c) const {
    const Capsule own{start[c].from + start[c].displacement(place), end[c].from + end[c].displacement(place),
                      radius[c]};
    if (carrier == nullptr) return own;
    return {carrier->to_world(own.start), carrier->to_world(own.end), radius[c]};
  }
  /// Largest speed that the carrier adds to `speed`, for a phalanx within `distance` of a point [m/s].
  double carried_speed(const Vector3& point, double distance) const {
    constexpr double kPhalanx = 0.3;  // longer than any, with its radius [m]
    if (carrier == nullptr) return 0.0;
    return carrier->twist.linear.norm() +
           carrier->twist.angular.norm() * ((point - carrier->centre).norm() + distance + kPhalanx);
  }
  /// Velocity of an end that is at `point` [m/s].
  Vector3 velocity(const EndPath& path, const Vector3& point) const {
    const Vector3 own = path.displacement(rate);
    if (carrier == nullptr) return own;
    return carrier->rotation * own + carrier->velocity(point);
  }
  /// `later` [s] than the step's start.
  Capsule capsule(int c, double later) const {
    Capsule result = capsule(c);
    result.start += later * velocity(start[c], result.start);
    result.end += later * velocity(end[c], result.end);
    return result;
  }
  PhalanxMotion motion(int c, const Capsule& now) const {
    PhalanxMotion motion;
    motion.axis = now.end - now.start;
    motion.velocity = start[c].displacement(rate);
    motion.spread = end[c].displacement(rate) - motion.velocity;
    if (carrier != nullptr) carrier->carry(now.start, motion);
    motion.spin = palm_spin;
    const double length_squared = motion.axis.squaredNorm();
    if (length_squared > 0.0) {
      const double inverse = 1.0 / length_squared;
      motion.swing = inverse * motion.axis.cross(motion.spread);
      motion.spin = motion.swing + (inverse * motion.axis.dot(palm_spin)) * motion.axis;
    }
    return motion;
  }
};

/// The hand of a track in a frame that lasts some time; made once a frame, then moved from step to step.
class HandMotion {
 public:
  /// `seconds` may be 0 for a hand that keeps still.
  HandMotion(const HandTrack& track, int slot, double seconds);

  /// The paths are in the frame of `carrier`, which is of the step's start in each move_to().
  void carry(const CarrierMotion* carrier);
  /// Moves the hand on to a step from `fraction` of the frame to `until`.
  void move_to(double fraction, double until);
  const MovingHand& hand() const { return hand_; }

 private:
  MovingHand hand_;
  double seconds_;
  bool spawned_;
  Matrix3 palm_orientation(double fraction) const;

  Matrix3 palm_from_;
  Vector3 palm_turn_, turn_start_bend_, turn_end_bend_;  // [rad]
};

/// Distance of two shapes at a time, and its rate.
template <typename Features>
struct Separation {
  Features features;
  double distance;  ///< [m]
  double rate;      ///< [m/s], < 0 approaches
};

/// First touch of two things in relative motion.
template <typename Features>
struct FirstTouch {
  double time;        ///< [s]
  Features features;  ///< then; distance about 0
};

/// Finds when the distance first becomes 0 within `duration` [s], if it does, by Newton's method from the
/// start; `separation(time)` returns an optional Separation, nothing where the two are far apart. For convex
/// shapes in relative translation the distance is convex in time, so that the iterations stay before the
/// first touch. Its rate is n.(v_a - v_b) of the two nearest points (envelope theorem).
///
/// Traps: rotation may make the distance concave, so that an iteration ends beyond the touch, with an
/// overlap. A pair that separates now is dropped, even if rotation would bring another corner in. A grazing
/// pair may use up all iterations, and does not touch then.
template <typename Features, typename SeparationAt>
std::optional<FirstTouch<Features>> first_touch(const SeparationAt& separation, double duration) {
  constexpr double kMaxTouchGap = 1e-6;  // [m]
  constexpr int kMaxSteps = 30;
  double time = 0.0;
  for (int i = 0; i < kMaxSteps; ++i) {
    const std::optional<Separation<Features>> now = separation(time);
    if (!now) return std::nullopt;
    if (now->distance <= kMaxTouchGap) return FirstTouch<Features>{time, now->features};
    if (now->rate >= 0.0) return std::nullopt;
    time += now->distance / -now->rate;
    if (time > duration) return std::nullopt;
  }
  return std::nullopt;
}

}  // namespace mrhi
