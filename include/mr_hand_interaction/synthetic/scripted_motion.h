#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/tracking/hand_skeleton.h"

namespace mrhi {

/// Pose of the hand at one time of a motion. Between keyframes it moves with minimum jerk.
struct Keyframe {
  double time;  ///< [s]
  Pose wrist;   ///< right hand's frame in world
  HandPosture posture;
  Vector3 velocity = Vector3::Zero();  ///< of the wrist [m/s]
  /// Posture at the fraction `via_share` of the path from the previous keyframe; 0: none.
  HandPosture via = HandPosture::Zero();
  double via_share = 0.0;
  /// Centre about which the hand rotates from the previous keyframe, along an arc [m, world]; empty: straight
  /// path.
  std::optional<Vector3> centre = std::nullopt;
  HandPosture rate = HandPosture::Zero();  ///< of the posture [rad/s]
};

struct HandPlace {
  Pose wrist;  ///< right hand's frame in world
  HandPosture posture;
};

/// Pose of the hand along the keyframes at `time`; constant before the first and after the last.
HandPlace hand_at(const std::vector<Keyframe>& keyframes, double time);

/// A scripted motion of one right hand, for one shipped scene. A function of time alone.
struct ScriptedMotion {
  std::string name;
  std::string scene;   ///< shipped scene
  Twist object_twist;  ///< start twist of the scene's object, world axes
  std::vector<Keyframe> keyframes;
  double pause = 1.0;  ///< between runs, without a hand in view [s]

  double run_time() const { return keyframes.back().time; }
  double period() const { return run_time() + pause; }
};

/// Names of the motions. With an object: grasp_cube grasp_ball catch_ball pinch_long lift_flat nudge tap
/// slap. With joints: press_button flip_switch turn_valve pull_lever open_drawer open_door open_hatch
/// squeeze_tongs.
std::vector<std::string> motion_names();

/// Throws std::invalid_argument that lists the names.
ScriptedMotion make_motion(const std::string& name);

/// Grasps the only free body of a scene at its start pose, across the narrowest width for thumb and fingers,
/// and carries it. Throws std::invalid_argument for several free bodies, or for one that no hand can grasp.
ScriptedMotion grasp_object(const Scene& scene);

/// Default pose of a desktop device in world: at the origin, y up becomes z up.
Pose default_device_mount();

/// Hands seen by the device `time` after the motion's start, in the device's frame: one hand, or none in the
/// pause. The motion repeats for ever, each run with a new hand id. A left hand performs it mirrored in
/// world's x.
JointsFrame sample(const ScriptedMotion& motion, Side side, Nanoseconds time, const Pose& device_in_world);

}  // namespace mrhi
