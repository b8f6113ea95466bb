#include <cmath>

#include "script.h"

namespace mrhi {
namespace {

constexpr double kHalfCube = 0.025;
constexpr double kPeakSpeed = 1.875;  // of minimum jerk, in lengths per duration

/// Index tip's centre where its skin touches the cube on the side that `normal` points out of.
Vector3 touching_tip(const Vector3& normal) {
  return scene_object() + (kHalfCube + human_hand().fingers[1].radius) * normal;
}

Keyframe key(double time, const Pose& wrist, const HandPosture& posture) {
  Keyframe frame;
  frame.time = time;
  frame.wrist = wrist;
  frame.posture = posture;
  return frame;
}

}  // namespace

ScriptedMotion nudge() {
  constexpr double kSpeed = 0.1, kWay = 0.09;
  const HandPosture posture = pointing_posture();
  const Vector3 forward = Vector3::UnitY();
  const Pose contact = wrist_for_index_tip(
      touching_tip(-forward), hand_pose(Vector3::Zero(), {0.0, 1.0, -0.1}, {0.0, 0.1, 1.0}), posture);
  const Pose ready = shifted(contact, -0.5 * kWay * forward);
  const Pose pushed = shifted(contact, 0.5 * kWay * forward);
  const Pose away = shifted(ready, {0.06, -0.10, 0.04});
  const double stroke = kPeakSpeed * kWay / kSpeed;
  ScriptedMotion motion;
  motion.scene = "cube";
  motion.keyframes = {key(0.0, away, relaxed_posture()),  key(0.9, ready, posture),
                      key(1.1, ready, posture),           key(1.1 + stroke, pushed, posture),
                      key(1.6 + stroke, pushed, posture), key(2.8 + stroke, away, relaxed_posture())};
  return motion;
}

ScriptedMotion tap() {
  constexpr double kSpeed = 0.5, kSwing = 40.0 * M_PI / 180.0;
  HandPosture touching = pointing_posture();
  touching.col(1) << 0.0, 0.1, 0.35, 0.2, 0.0;
  HandPosture raised = touching, struck = touching;
  raised(kBaseFlexion, 1) -= 0.5 * kSwing;
  struck(kBaseFlexion, 1) += 0.5 * kSwing;
  const auto finger = finger_joints(human_hand().fingers[1], touching.col(1));
  const double stroke = kPeakSpeed * kSwing * (finger[4] - finger[1]).norm() / kSpeed;
  // Pitched so that the tip passes the level of its knuckle where it meets the cube: it strikes straight
  // down.
  const Vector3 chord = finger[4] - finger[1];
  const double pitch = std::atan2(-chord.z(), chord.x());
  const Vector3 fingers(0.0, std::cos(pitch), std::sin(pitch)),
      dorsal(0.0, -std::sin(pitch), std::cos(pitch));
  const Pose at = wrist_for_index_tip(touching_tip(Vector3::UnitZ()),
                                      hand_pose(Vector3::Zero(), fingers, dorsal), touching);
  const Pose away = shifted(at, {0.06, -0.16, 0.06});
  ScriptedMotion motion;
  motion.scene = "cube";
  motion.keyframes = {key(0.0, away, relaxed_posture()),
                      key(1.0, at, raised),
                      key(1.3, at, raised),
                      key(1.3 + stroke, at, struck),
                      key(1.7 + stroke, at, raised),
                      key(2.1 + stroke, at, raised),
                      key(3.1 + stroke, away, relaxed_posture())};
  return motion;
}

ScriptedMotion slap() {
  constexpr double kSpeed = 1.5, kBefore = 0.26, kAfter = 0.26;
  const HandPosture posture = flat_posture();
  const Vector3 swing(-1.0, 0.0, 0.0);
  // The cube's centre ahead of the middle finger's knuckle, the hand upright with the thumb up.
  const auto middle = finger_joints(human_hand().fingers[2], posture.col(2));
  const Pose direction = hand_pose(Vector3::Zero(), Vector3::UnitY(), -swing);
  const Vector3 meeting(middle[1].x() + 0.010, middle[1].y(), middle[1].z() - human_hand().fingers[2].radius);
  const Pose contact{scene_object() - kHalfCube * swing - direction.orientation * meeting,
                     direction.orientation};
  const Pose drawn = shifted(contact, -kBefore * swing), through = shifted(contact, kAfter * swing);
  const double stroke = kPeakSpeed * (kBefore + kAfter) / kSpeed;
  ScriptedMotion motion;
  motion.scene = "cube";
  motion.keyframes = {key(0.0, shifted(drawn, {0.02, -0.10, 0.0}), relaxed_posture()),
                      key(0.8, drawn, posture),
                      key(1.0, drawn, posture),
                      key(1.0 + stroke, through, posture),
                      key(1.4 + stroke, through, posture),
                      key(2.3 + stroke, shifted(through, {0.0, -0.12, -0.02}), relaxed_posture())};
  return motion;
}

}  // namespace mrhi
