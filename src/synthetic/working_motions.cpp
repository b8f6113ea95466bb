#include <cmath>

#include "script.h"
#include "scripted_grasp.h"

namespace mrhi {
namespace {

constexpr double kThumbDepth = 0.006, kFingerDepth = 0.003;  // that the tips press beyond the surface [m]

/// The wrist of one who points away from the body, palm down.
Pose pointing_forward() {
  return hand_pose(Vector3::Zero(), {0.0, 1.0, -0.25}, {0.0, 0.25, 1.0});
}

/// Where the index finger's tip is, touching a surface at `point` with the skin.
Pose touching(const Vector3& point, const Vector3& normal) {
  const Vector3 tip = point + human_hand().fingers[1].radius * normal;
  return wrist_for_index_tip(tip, pointing_forward(), pointing_posture());
}

/// Thumb and two fingers on either side of an upright bar, palm to the panel, fingers to the right. Its frame
/// is world's at the bar's middle.
Grasp bar_grasp(double width) {
  HandPosture preferred;
  preferred << 25, 0, 0, 0, -4,  //
      5, 50, 50, 80, 80,         //
      15, 38, 38, 95, 95,        //
      30, 25, 25, 60, 60,        //
      35, 0, 0, 0, 0;
  const double x = 0.5 * width;
  const Vector3 right = Vector3::UnitX();
  return {hand_pose({-0.0443, -0.1067, -0.0186}, {0.878, 0.377, 0.296}, {0.311, -0.918, 0.246}),
          {{0, {-x, 0.0, 0.0}, -right, kThumbDepth},
           {1, {x, 0.0, 0.009}, right, kFingerDepth},
           {2, {x, 0.0, -0.009}, right, kFingerDepth}},
          posture_of_degrees(preferred),
          0.014,
          -Vector3::UnitY()};
}

/// Fingers under a level bar and the thumb on it, palm up.
Grasp rail_grasp(double width) {
  HandPosture preferred;
  preferred << 30, 0, 0, 0, -2,  //
      5, 60, 60, 60, 55,         //
      15, 35, 38, 38, 40,        //
      25, 22, 22, 22, 22,        //
      30, 0, 0, 0, 0;
  const double z = 0.5 * width;
  const Vector3 up = Vector3::UnitZ();
  return {hand_pose({0.001, -0.0759, -0.0371}, {0.278, 0.774, -0.568}, {0.399, -0.631, -0.665}),
          {{0, {0.0, 0.0, z}, up, kThumbDepth},
           {1, {0.018, 0.0, -z}, -up, 0.002},
           {2, {0.0, 0.0, -z}, -up, 0.002},
           {3, {-0.018, 0.0, -z}, -up, 0.002}},
          posture_of_degrees(preferred),
          0.015,
          -Vector3::UnitY()};
}

/// A hand that takes hold of something, moves it and lets go.
class Grip {
 public:
  Grip(Script& script, const Grasp& grasp, const Vector3& place)
      : script_(script),
        postures_(grasp),
        retreat_(grasp.retreat),
        at_(Pose{place, Quaternion::Identity()} * grasp.wrist) {}

  Grip& take(const Vector3& aside) {
    constexpr double kApproach = 0.08;
    const Pose before = shifted(at_, kApproach * retreat_);
    if (script_.motion().keyframes.empty()) script_.then(0.0, shifted(before, aside), relaxed_posture());
    script_.then(0.9, before, postures_.open, -0.1 * retreat_).then(0.8, at_, postures_.open);
    script_.then(0.6, at_, postures_.near).then(0.7, at_, postures_.pressing);
    script_.by_way_of(postures_.touching, postures_.touching_share).hold(0.3);
    return *this;
  }
  Grip& slide(double duration, const Vector3& by) {
    at_ = shifted(at_, by);
    script_.then(duration, at_, postures_.pressing);
    return *this;
  }
  Grip& turn_about(double duration, const Vector3& centre, const Quaternion& by) {
    at_ = {centre + by * (at_.position - centre), by * at_.orientation};
    retreat_ = by * retreat_;
    script_.then(duration, at_, postures_.pressing).round(centre);
    return *this;
  }
  Grip& let_go(const Vector3& aside) {
    script_.hold(0.4).then(0.7, at_, postures_.near);
    script_.by_way_of(postures_.touching, 1.0 - postures_.touching_share);
    const Pose off = shifted(at_, 0.07 * retreat_);
    script_.then(0.5, at_, postures_.open).then(0.7, off, postures_.open, 0.1 * retreat_);
    script_.then(0.8, shifted(off, aside), relaxed_posture());
    return *this;
  }

 private:
  Script& script_;
  GraspPostures postures_;
  Vector3 retreat_;
  Pose at_;
};

const Vector3 kBeside(0.03, -0.08, 0.03);  // where the hand comes from, and goes to [m]

/// A fingertip that touches at `place`, moves on by `way` in that time, and comes back.
ScriptedMotion push(const Vector3& place, const Vector3& normal, const Vector3& way, double duration) {
  const Vector3 ready = 0.03 * normal;
  const Pose at = touching(place, normal), off = shifted(at, ready);
  const HandPosture posture = pointing_posture();
  Script script("panel");
  script.then(0.0, shifted(off, kBeside), relaxed_posture()).then(0.9, off, posture).hold(0.2);
  script.then(duration, shifted(at, way), posture).hold(0.4).then(0.8 * duration, off, posture);
  script.then(0.9, shifted(off, kBeside), relaxed_posture());
  return script.motion();
}

}  // namespace

ScriptedMotion press_button() {
  return push({-0.2, 0.12, 0.36}, -Vector3::UnitY(), {0.0, 0.012, 0.0}, 1.0);
}

/// Down on its end, which stands up at 20 degrees.
ScriptedMotion flip_switch() {
  return push({-0.11, 0.123, 0.3755}, Vector3::UnitZ(), {0.0, 0.0, -0.024}, 1.2);
}

ScriptedMotion pull_lever() {
  return push({0.16, 0.085, 0.368}, Vector3::UnitZ(), {0.0, 0.0, -0.03}, 1.2);
}

/// A quarter of a turn by its upper arm.
ScriptedMotion turn_valve() {
  const Vector3 axle(0.01, 0.12, 0.34);
  Script script("panel");
  Grip grip(script, bar_grasp(0.014), axle + Vector3(0.0, 0.0, 0.031));
  grip.take(kBeside).turn_about(1.6, axle, turn(60.0, Vector3::UnitY())).let_go(kBeside);
  return script.motion();
}

ScriptedMotion open_drawer() {
  Script script("panel");
  Grip grip(script, rail_grasp(0.012), {-0.13, 0.10, 0.15});
  grip.take({0.0, -0.08, 0.0}).slide(1.6, {0.0, -0.12, 0.0}).let_go({0.0, -0.03, 0.0});
  return script.motion();
}

ScriptedMotion open_door() {
  const Vector3 hinge(0.2, 0.14, 0.17);
  Script script("panel");
  Grip grip(script, bar_grasp(0.012), {0.075, 0.10, 0.17});
  grip.take(kBeside).turn_about(2.0, hinge, turn(60.0, Vector3::UnitZ())).let_go({0.0, -0.03, 0.0});
  return script.motion();
}

namespace {

constexpr double kHatchFace = 0.115;  // where a fingertip is that turns a latch: before the hatch [m]

/// The fingertip takes a latch at 45 mm from its axle, `up` or down, by a quarter of a turn. It is on the arc
/// by its places and velocities at every 30 degrees.
void turn_latch(Script& script, const Vector3& axle, double up) {
  constexpr double kArm = 0.04, kUnder = 0.006, kParts = 3.0, kAngle = M_PI / 2.0, kTime = 2.0;
  const double radius = human_hand().fingers[1].radius;
  const HandPosture posture = pointing_posture();
  const auto tip = [&](double angle, double under) {
    const double c = std::cos(angle), s = std::sin(angle);
    return Vector3(axle.x() + kArm * c + under * s, kHatchFace, axle.z() + up * (kArm * s - under * c));
  };
  const auto wrist = [&](double angle, double under) {
    return wrist_for_index_tip(tip(angle, under), pointing_forward(), posture);
  };
  const double touching = kUnder + radius, off = touching + 0.015;
  const Vector3 back(0.0, -0.04, 0.0);
  script.then(0.9, shifted(wrist(0.0, off), back), posture).then(0.5, wrist(0.0, off), posture);
  script.then(0.5, wrist(0.0, touching), posture, Vector3::Zero());
  for (double part = 1.0; part <= kParts; part += 1.0) {
    const double angle = kAngle * part / kParts, rate = part < kParts ? 1.2 * kAngle / kTime : 0.0;
    const Vector3 along = (tip(angle + 1e-4, touching) - tip(angle - 1e-4, touching)) / 2e-4;
    script.then(kTime / kParts, wrist(angle, touching), posture, rate * along);
  }
  script.hold(0.2).then(0.4, wrist(kAngle, off), posture);
  script.then(0.5, shifted(wrist(kAngle, off), back), posture);
}

/// Fingers on an arm of tongs are as much farther apart than on a cube.
constexpr double kApart = 1.3;

/// Tips on the arms of tongs at half their length, each arm at `angle` from the middle; in the scene's
/// object's frame.
Grasp tongs_grasp(double angle) {
  Grasp grasp = shipped_grasp("cube");
  const double c = std::cos(angle), s = std::sin(angle);
  for (FingertipContact& contact : grasp.contacts) {
    contact.depth *= 1.7;  // arms give way, and the grip with them
    const double side = contact.finger == 0 ? -1.0 : 1.0, along = 0.07 + kApart * contact.point.x();
    contact.normal = {-s, side * c, 0.0};
    contact.point = Vector3(-0.07 + along * c, side * along * s, 0.0) + 0.004 * contact.normal;
  }
  return grasp;
}

}  // namespace

/// Both latches, then the hatch by its handle.
ScriptedMotion open_hatch() {
  const Vector3 hinge(0.12, 0.14, 0.25);
  Script script("hatch");
  script.then(0.0, shifted(touching({-0.09, 0.02, 0.30}, -Vector3::UnitY()), kBeside), relaxed_posture());
  turn_latch(script, {-0.13, 0.123, 0.33}, 1.0);
  turn_latch(script, {-0.13, 0.123, 0.17}, -1.0);
  Grip grip(script, bar_grasp(0.012), {-0.07, 0.10, 0.25});
  grip.take(kBeside).turn_about(2.4, hinge, turn(60.0, Vector3::UnitZ())).let_go({0.0, -0.03, 0.0});
  return script.motion();
}

ScriptedMotion squeeze_tongs() {
  const Grasp open_grasp = tongs_grasp(0.29);
  const GraspPostures open(open_grasp), half(tongs_grasp(0.2)), closed(tongs_grasp(0.1));
  const Pose at = Pose{scene_object(), Quaternion::Identity()} * open_grasp.wrist;
  const Pose before = shifted(at, 0.10 * open_grasp.retreat);
  const Vector3 aside(0.05, -0.16, 0.02);
  Script script("tongs");
  script.then(0.0, shifted(before, aside), relaxed_posture());
  script.then(0.9, before, open.open, -0.15 * open_grasp.retreat).then(0.8, at, open.open);
  script.then(0.6, at, open.near).then(0.7, at, open.pressing).by_way_of(open.touching, open.touching_share);
  for (int squeeze = 0; squeeze < 2; ++squeeze)
    script.then(1.0, at, closed.pressing).hold(0.3).then(1.0, at, half.pressing).hold(0.2);
  script.then(0.5, at, open.pressing);
  script.then(0.7, at, open.near).by_way_of(open.touching, 1.0 - open.touching_share);
  script.then(0.5, at, open.open).then(0.7, before, open.open, 0.1 * open_grasp.retreat);
  script.then(0.8, shifted(before, aside), relaxed_posture());
  return script.motion();
}

}  // namespace mrhi
