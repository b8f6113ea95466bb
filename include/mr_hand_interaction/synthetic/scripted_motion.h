#pragma once

#include <optional>
#include <string>
#include <vector>

#include "mr_hand_interaction/scene/scene.h"
#include "mr_hand_interaction/synthetic/hand_skeleton.h"

namespace mrhi {

/// Where the hand is at one time of a motion; between keyframes it moves with minimum jerk.
struct Keyframe {
  double time;  ///< [s]
  Pose wrist;   ///< right hand's frame in world
  HandPosture posture;
  Vector3 velocity = Vector3::Zero();  ///< of the wrist [m/s]
  /// Posture passed on the way here from the keyframe before, at the share `via_share` of the way; 0: none.
  HandPosture via = HandPosture::Zero();
  double via_share = 0.0;
  /// The hand turns about this point on the way here, which is then an arc [m, world]; nothing: straight.
  std::optional<Vector3> centre = std::nullopt;
};

struct HandPlace {
  Pose wrist;  ///< right hand's frame in world
  HandPosture posture;
};

/// The hand at a time of the way through the keyframes; before the first and after the last it rests there.
HandPlace hand_at(const std::vector<Keyframe>& keyframes, double time);

/// A scripted motion of one right hand, made for one shipped scene. A function of time alone.
struct ScriptedMotion {
  std::string name;
  std::string scene;   ///< the shipped scene that it is for
  Twist object_twist;  ///< that the scene's object is to start with, world axes
  std::vector<Keyframe> keyframes;
  double pause = 1.0;  ///< without a hand in view before the next run [s]

  double run_time() const { return keyframes.back().time; }
  double period() const { return run_time() + pause; }
};

/// Those of one object, grasp_cube grasp_ball catch_ball pinch_long lift_flat nudge tap slap, and those of
/// joints, press_button flip_switch turn_valve pull_lever open_drawer open_door open_hatch squeeze_tongs.
std::vector<std::string> motion_names();

/// Throws std::invalid_argument that lists the names.
ScriptedMotion make_motion(const std::string& name);

/// Grasps the only free body of a scene where it starts, by a narrow part such as a side, a wall or a handle,
/// and carries it: the first grasp that holds it in simulation. Takes up to some seconds. Throws
/// std::invalid_argument for a scene of several free bodies, and for a body that no grasp holds.
ScriptedMotion grasp_object(const Scene& scene);

/// Pose of a desktop device in world unless a user says otherwise: at the origin, y up becomes z up.
Pose default_device_mount();

/// What the device sees `time` seconds after the motion began, in the device's frame: one hand, or none in
/// the pause. The motion repeats for ever, each run with a hand id of its own; a left hand does it mirrored
/// in world's x.
JointsFrame sample(const ScriptedMotion& motion, Side side, Nanoseconds time, const Pose& device_in_world);

}  // namespace mrhi
