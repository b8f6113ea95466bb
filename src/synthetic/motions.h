#pragma once

#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "scripted_grasp.h"

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

/// Angles in degrees, a row per joint.
HandPosture posture_of_degrees(const HandPosture& degrees);

/// Builds a motion keyframe by keyframe.
class Script {
 public:
  explicit Script(const char* scene) { motion_.scene = scene; }

  Script& then(double duration, const Pose& wrist, const HandPosture& posture,
               const Vector3& velocity = Vector3::Zero()) {
    const double start = motion_.keyframes.empty() ? 0.0 : motion_.keyframes.back().time;
    Keyframe key;
    key.time = start + duration;
    key.wrist = wrist;
    key.posture = posture;
    key.velocity = velocity;
    motion_.keyframes.push_back(key);
    return *this;
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

}  // namespace mrhi
