#pragma once

#include <string>
#include <vector>

#include "mr_hand_interaction/scene/body.h"
#include "mr_hand_interaction/synthetic/hand_skeleton.h"
#include "mr_hand_interaction/synthetic/scripted_motion.h"

namespace mrhi {

/// Where the shipped scenes of one object have it.
inline Vector3 scene_object() {
  return {0.0, 0.0, 0.22};
}

/// Hand frame at `wrist` whose x is along `fingers` and whose z is as near to `dorsal` as that allows.
Pose hand_pose(const Vector3& wrist, const Vector3& fingers, const Vector3& dorsal);

/// Turn about a unit axis.
Quaternion turn(double degrees, const Vector3& axis);

/// Wrist that puts the right hand's index tip at `tip`, turned as `direction` is.
Pose wrist_for_index_tip(const Vector3& tip, const Pose& direction, const HandPosture& posture);

/// Angles in degrees: a row per joint, in each a column per finger; 0 where a row ends early.
HandPosture posture_of_degrees(const double (&degrees)[kFingerJoints][kFingers]);

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
    const double start = motion_.keyframes.empty() ? 0.0 : motion_.keyframes.back().time;
    return at(start + duration, wrist, posture, velocity);
  }
  Script& hold(double duration) {
    const Keyframe last = motion_.keyframes.back();
    return then(duration, last.wrist, last.posture);
  }
  /// The last keyframe's posture is reached by way of another.
  Script& by_way_of(const HandPosture& posture, double share) {
    motion_.keyframes.back().via = posture;
    motion_.keyframes.back().via_share = share;
    return *this;
  }
  /// The last keyframe is reached along an arc about a point, with which the hand turns.
  Script& round(const Vector3& centre) {
    motion_.keyframes.back().centre = centre;
    return *this;
  }
  Script& object_twist(const Twist& twist) {
    motion_.object_twist = twist;
    return *this;
  }
  ScriptedMotion motion() const { return motion_; }

 private:
  ScriptedMotion motion_;
};

inline Pose shifted(const Pose& pose, const Vector3& by) {
  return {pose.position + by, pose.orientation};
}

struct Reach {
  FingerAngles angles;
  double error;  ///< distance that remains between tip and target [m]
};

/// Angles within the limits that bring the end of the last bone to `target` (right hand's frame), as near to
/// `preferred` as that allows: damped least squares with the preference in the null space (Nakamura &
/// Hanafusa 1986).
Reach reach(const FingerSkeleton& finger, const Vector3& target, const FingerAngles& preferred,
            int iterations = 200);

/// Where a fingertip is to touch an object: a point of its surface and the outward normal there.
struct FingertipContact {
  int finger;
  Vector3 point;
  Vector3 normal;
  double depth;  ///< how far the tip is to press beyond the surface [m]
};

/// `preferred` with the fingers of `contacts` placed so that their tips, as spheres of the finger's radius,
/// are `gap` off the surface, or at each contact's depth if gap is negative. Contacts in the frame that
/// `wrist` is in; right hand. `worst_error`, if given, becomes the largest Reach::error.
HandPosture place_fingertips(const HandSkeleton& skeleton, const Pose& wrist,
                             const std::vector<FingertipContact>& contacts, double gap,
                             const HandPosture& preferred, double* worst_error = nullptr);

/// How a right hand holds an object: everything in the object's frame.
struct Grasp {
  Pose wrist;  ///< while the object is held
  std::vector<FingertipContact> contacts;
  HandPosture preferred;  ///< that the fingers are near to
  double opening;         ///< of each fingertip before closing and after [m]
  Vector3 retreat;        ///< unit: the way by which the open hand leaves the object

  Grasp turned(const Quaternion& by) const;
};

/// Postures of a hand round an object: open, nearly touching, just touching with all tips, pressing. From one
/// to the next but the first each tip moves in proportion to its depth, so that the springs of tips whose
/// depths balance stay in balance all the way: closing and opening do not push the object.
struct GraspPostures {
  HandPosture open, near, touching, pressing;
  double touching_share;  ///< of the way from near to pressing

  explicit GraspPostures(const Grasp& grasp);
};

/// Of the shipped objects cube, ball, long_cuboid and flat_cuboid. Throws std::invalid_argument that lists
/// them.
Grasp shipped_grasp(const std::string& object);

/// Grasp of any object, in the body's frame: between two opposite surfaces that thumb and fingers reach,
/// narrow and near the centre of mass. Throws std::invalid_argument that names the object and what is
/// allowed.
Grasp find_grasp(const Body& body);

/// Grasp of a body: the shipped one of its name, else find_grasp(), and throws as that does.
Grasp grasp_of(const Body& body);

/// Reaches for an object at rest whose centre is at `object`, closes, carries and lets go; `scene` names its
/// scene, `aside` is where the hand comes from [m, world].
ScriptedMotion reach_and_carry(const char* scene, const Grasp& grasp, const Vector3& object,
                               const Vector3& aside);

/// Postures of a hand round an object from open to pressed deep into it. `depth` is what thumb and fingers
/// together close beyond its surface; each tip has its share of it. Below 0 the tips are off the surface.
class GripPostures {
 public:
  /// `grasp`'s depths are shares: those of its first two contacts make up one. `deepest` > 0 [m].
  GripPostures(const Grasp& grasp, double deepest);

  HandPosture open, near;  ///< near: just off the surface
  double near_depth;       ///< of `near`, below 0 [m]
  /// Between near_depth and the deepest; beyond, at that end.
  HandPosture at(double depth) const;
  double deepest() const { return deepest_; }

 private:
  double deepest_;
  std::vector<HandPosture> pressed_;  ///< evenly spaced from depth 0 to the deepest
};

/// Turns of a body of one box about its centre that leave its outline as it is, the identity first; of others
/// the identity alone.
std::vector<Quaternion> box_symmetries(const Body& body);

}  // namespace mrhi
