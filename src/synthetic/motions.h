#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "mr_hand_interaction/tracking/hand_skeleton.h"

namespace mrhi {

/// Position of the object in the shipped scenes with one.
inline Vector3 scene_object() {
  return {0.0, 0.0, 0.22};
}

constexpr double kApproachLength = 0.10;  ///< straight to the object with the hand open [m]

/// Hand frame at `wrist`, with x along `fingers` and z as close to `dorsal` as possible.
Pose hand_pose(const Vector3& wrist, const Vector3& fingers, const Vector3& dorsal);

/// Rotation about a unit axis.
Quaternion turn(double degrees, const Vector3& axis);

/// Wrist pose that puts the right hand's index tip at `tip`, with the orientation of `direction`.
Pose wrist_for_index_tip(const Vector3& tip, const Pose& direction, const HandPosture& posture);

/// Adds a keyframe `duration` after the last one, or after 0 [s].
inline void append(std::vector<Keyframe>& keyframes, double duration, const Pose& wrist,
                   const HandPosture& posture, const Vector3& velocity = Vector3::Zero()) {
  const double start = keyframes.empty() ? 0.0 : keyframes.back().time;
  keyframes.push_back({start + duration, wrist, posture, velocity});
}

/// Builds a motion keyframe by keyframe.
class Script {
 public:
  explicit Script(const char* scene) { motion_.scene = scene; }

  Script& at(double time, const Pose& wrist, const HandPosture& posture,
             const Vector3& velocity = Vector3::Zero()) {
    motion_.keyframes.push_back({time, wrist, posture, velocity});
    return *this;
  }
  /// `duration` after the last keyframe [s].
  Script& then(double duration, const Pose& wrist, const HandPosture& posture,
               const Vector3& velocity = Vector3::Zero()) {
    append(motion_.keyframes, duration, wrist, posture, velocity);
    return *this;
  }
  Script& hold(double duration) {
    const Keyframe last = motion_.keyframes.back();
    return then(duration, last.wrist, last.posture);
  }
  /// Adds a posture between the last two keyframes, at this fraction of the path.
  Script& via_posture(const HandPosture& posture, double fraction) {
    motion_.keyframes.back().via = posture;
    motion_.keyframes.back().via_share = fraction;
    return *this;
  }
  /// Makes the path to the last keyframe an arc about a point, with which the hand rotates.
  Script& round(const Vector3& centre) {
    motion_.keyframes.back().centre = centre;
    return *this;
  }
  ScriptedMotion motion() const { return motion_; }

 private:
  ScriptedMotion motion_;
};

inline Pose shifted(const Pose& pose, const Vector3& by) {
  return {pose.position + by, pose.orientation};
}
std::vector<Keyframe> shifted(std::vector<Keyframe> keyframes, const Vector3& by);

struct FingerSolution {
  FingerAngles angles;
  double error;  ///< remaining distance between tip and target [m]
};

/// Inverse kinematics of a finger: angles within the limits that bring the end of the last bone to `target`
/// (right hand's frame), as close to `preferred` as possible. Damped least squares with the preference in the
/// null space (Nakamura & Hanafusa 1986).
FingerSolution solve_finger(const FingerSkeleton& finger, const Vector3& target,
                            const FingerAngles& preferred, int iterations = 200);

/// Planned contact of a fingertip: a point of the object's surface and the outward normal there.
struct FingertipContact {
  int finger;
  Vector3 point;
  Vector3 normal;
  double depth;  ///< of the fingertip beyond the surface [m]
};

/// A right hand's grasp of an object, in the object's frame.
struct Grasp {
  Pose wrist;  ///< while the object is held
  std::vector<FingertipContact> contacts;
  HandPosture preferred;  ///< posture to which the fingers stay close
  double opening;         ///< gap of each fingertip before closing and after [m]
  Vector3 retreat;        ///< unit: direction in which the open hand leaves the object

  Grasp turned(const Quaternion& by) const;
  /// Reaches for a contact, so that the tip, as a sphere of the finger's radius, is `gap` off the surface; if
  /// gap is negative, at the contact's depth.
  FingerSolution solve_contact(const FingertipContact& contact, double gap, int iterations = 200) const;
  /// The preferred posture with the fingers of the contacts placed likewise.
  HandPosture posture(double gap) const;
};

/// Postures of a hand around an object: open, nearly touching, just touching with all tips, and holding.
/// Between the last three each tip moves in proportion to its depth. So springs that balance at the full
/// depths balance throughout, and closing and opening do not push the object.
struct GraspPostures {
  HandPosture open, near, touching, closed;
  double touching_fraction;  ///< fraction of the path from near to holding

  explicit GraspPostures(const Grasp& grasp);
};

/// Grasp of a shipped object: cube, ball, long_cuboid or flat_cuboid. Throws std::invalid_argument that lists
/// them.
Grasp shipped_grasp(const std::string& object);

/// Grasp of any object, in the body's frame: between two opposite surfaces that thumb and fingers reach,
/// narrow and near the centre of mass. Throws std::invalid_argument that names the object and what is
/// allowed.
Grasp find_grasp(const Body& body);

/// Grasp of a body: the shipped one of its name, else find_grasp(), and throws as that does.
Grasp grasp_of(const Body& body);

/// Reaches for an object at rest with its centre at `object`, closes, carries and releases it. `scene` is the
/// name of its scene; the hand comes from `aside` [m, world].
ScriptedMotion reach_and_carry(const char* scene, const Grasp& grasp, const Vector3& object,
                               const Vector3& aside);

/// Postures of a hand around an object, from open to deep beyond its surface. `depth` is that of thumb and
/// fingers together, of which each tip has its fraction. Below 0 the tips are off the surface.
class GripPostures {
 public:
  /// `grasp`'s depths are fractions: those of its first two contacts sum to one. `deepest` > 0 [m].
  GripPostures(const Grasp& grasp, double deepest);

  HandPosture open, near;  ///< near: just off the surface
  double near_depth;       ///< of `near`, below 0 [m]
  /// Posture at a depth, clamped to near_depth and the deepest.
  HandPosture at(double depth) const;
  double deepest() const { return deepest_; }

 private:
  double deepest_;
  std::vector<HandPosture> closed_;  ///< evenly spaced from depth 0 to the deepest
};

/// A right hand round a bar, which lies across the palm, along y of the hand's frame. The fingers close until
/// they press; between `near` and `closed` they touch.
struct PowerGrip {
  explicit PowerGrip(double radius);  ///< of the bar [m]

  Vector3 bar;  ///< a point of its axis, in the hand's frame
  HandPosture open, near, closed;
};

/// Left hand's frame for a right hand's, mirrored in x.
Pose mirrored(const Pose& wrist);

/// Rotations of a body of one box about its centre that preserve its shape, identity first; for others only
/// the identity.
std::vector<Quaternion> box_symmetries(const Body& body);

}  // namespace mrhi
