#pragma once

#include "fingertip_reach.h"
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

/// Angles in degrees, a row per joint.
HandPosture posture_of_degrees(const HandPosture& degrees);

ScriptedMotion grasp_cube();
ScriptedMotion grasp_ball();
ScriptedMotion catch_ball();
ScriptedMotion pinch_long();
ScriptedMotion lift_flat();
ScriptedMotion nudge();
ScriptedMotion tap();
ScriptedMotion slap();
ScriptedMotion press_button();
ScriptedMotion flip_switch();
ScriptedMotion turn_valve();
ScriptedMotion pull_lever();
ScriptedMotion open_drawer();
ScriptedMotion open_door();
ScriptedMotion open_hatch();
ScriptedMotion squeeze_tongs();

}  // namespace mrhi
