#include "motions.h"

#include <cmath>
#include <functional>
#include <stdexcept>

#include "../text/text.h"

namespace mrhi {
namespace {

constexpr double kStartDistance = 0.16;  // further away, where the hand comes from [m]

/// Opens the hand around an object at `at`, withdraws it to `off` along `retreat` and on to `aside`.
void release(Script& script, const GraspPostures& postures, const Pose& at, const Pose& off,
             const Vector3& retreat, const Pose& aside) {
  script.then(0.7, at, postures.near).via_posture(postures.touching, 1.0 - postures.touching_fraction);
  script.then(0.5, at, postures.open).then(0.7, off, postures.open, 0.1 * retreat);
  script.then(0.8, aside, relaxed_posture());
}

/// A hand that grasps an object, moves it and releases it.
class GraspScript {
 public:
  /// Continues `script`.
  GraspScript(Script script, const Grasp& grasp, const Vector3& place)
      : script_(std::move(script)),
        postures_(grasp),
        retreat_(grasp.retreat),
        at_(Pose{place, Quaternion::Identity()} * grasp.wrist) {}

  /// Approaches from `aside` of a point straight in front of the object, at `distance` [m] and `speed` [m/s].
  GraspScript& take(const Vector3& aside, double distance = 0.08, double speed = 0.1) {
    const Pose before = shifted(at_, distance * retreat_);
    if (script_.motion().keyframes.empty()) script_.then(0.0, shifted(before, aside), relaxed_posture());
    script_.then(0.9, before, postures_.open, -speed * retreat_).then(0.8, at_, postures_.open);
    script_.then(0.6, at_, postures_.near).then(0.7, at_, postures_.closed);
    script_.via_posture(postures_.touching, postures_.touching_fraction);
    return *this;
  }
  GraspScript& hold(double duration) {
    script_.hold(duration);
    return *this;
  }
  GraspScript& slide(double duration, const Vector3& by) {
    at_ = shifted(at_, by);
    script_.then(duration, at_, postures_.closed);
    return *this;
  }
  GraspScript& turn_about(double duration, const Vector3& centre, const Quaternion& by) {
    at_ = {centre + by * (at_.position - centre), by * at_.orientation};
    retreat_ = by * retreat_;
    script_.then(duration, at_, postures_.closed).round(centre);
    return *this;
  }
  ScriptedMotion let_go(const Vector3& aside) {
    const Pose off = shifted(at_, 0.07 * retreat_);
    release(script_.hold(0.4), postures_, at_, off, retreat_, shifted(off, aside));
    return script_.motion();
  }

  const GraspPostures& postures() const { return postures_; }
  Script& script() { return script_; }

 private:
  Script script_;
  GraspPostures postures_;
  Vector3 retreat_;
  Pose at_;
};

/// Carries a held object, with its centre at `centre`, to another pose, holds and releases it, and withdraws.
void carry_and_release(Script& script, const Grasp& grasp, const GraspPostures& postures,
                       const Vector3& centre, const Pose& carried, const Vector3& aside) {
  const Pose target = Pose{centre, Quaternion::Identity()} * carried;
  const Pose wrist = target * grasp.wrist;
  const Vector3 retreat = carried.orientation * grasp.retreat;
  release(script.then(1.4, wrist, postures.closed).hold(0.6), postures, wrist,
          shifted(wrist, kApproachLength * retreat), retreat,
          shifted(wrist, kApproachLength * retreat + aside));
}

/// Makes a motion.
using Make = std::function<ScriptedMotion()>;

Make carry(const char* object, const Vector3& aside) {
  return [=] { return reach_and_carry(object, shipped_grasp(object), scene_object(), aside); };
}

ScriptedMotion catch_ball() {
  constexpr double kMeet = 0.7, kClose = 0.3, kSqueeze = 0.4, kStop = 0.5, kStart = 0.4;  // [s]
  const Vector3 velocity(0.0, -0.3, 0.0);
  const Grasp grasp = shipped_grasp("ball").turned(turn(90.0, Vector3::UnitX()));
  const GraspPostures postures(grasp);
  const auto wrist_round = [&](const Vector3& ball) {
    return Pose{ball, Quaternion::Identity()} * grasp.wrist;
  };
  const Vector3 met = scene_object() + kMeet * velocity;
  const Vector3 near = met + kClose * velocity, closed = near + kSqueeze * velocity;
  const Vector3 stopped = closed + 0.5 * kStop * velocity;
  Script script("ball");
  script.then(0.0, wrist_round(met - 0.5 * kStart * velocity), postures.open).hold(kMeet - kStart);
  script.then(kStart, wrist_round(met), postures.open, velocity);
  script.then(kClose, wrist_round(near), postures.near, velocity);
  script.then(kSqueeze, wrist_round(closed), postures.closed, velocity);
  script.via_posture(postures.touching, postures.touching_fraction);
  script.then(kStop, wrist_round(stopped), postures.closed).hold(0.3);
  const Pose carried{{0.0, 0.08, 0.06}, turn(20.0, Vector3::UnitX())};
  carry_and_release(script, grasp, postures, stopped, carried, {0.08, 0.0, -0.05});
  ScriptedMotion motion = script.motion();
  motion.object_twist.linear = velocity;
  return motion;
}

constexpr double kHalfCube = 0.025;
constexpr double kPeakSpeed = 1.875;  // of minimum jerk, in lengths per duration

/// Centre of the index tip when its skin touches the cube's face with this normal.
Vector3 touching_tip(const Vector3& normal) {
  return scene_object() + (kHalfCube + human_hand().fingers[1].radius) * normal;
}

ScriptedMotion nudge() {
  constexpr double kSpeed = 0.1, kStroke = 0.09;
  const HandPosture posture = pointing_posture();
  const Vector3 forward = Vector3::UnitY();
  const Pose contact = wrist_for_index_tip(
      touching_tip(-forward), hand_pose(Vector3::Zero(), {0.0, 1.0, -0.1}, {0.0, 0.1, 1.0}), posture);
  const Pose ready = shifted(contact, -0.5 * kStroke * forward);
  const Pose pushed = shifted(contact, 0.5 * kStroke * forward);
  const Pose away = shifted(ready, {0.06, -0.10, 0.04});
  const double stroke = kPeakSpeed * kStroke / kSpeed;
  Script script("cube");
  script.at(0.0, away, relaxed_posture()).at(0.9, ready, posture).at(1.1, ready, posture);
  script.at(1.1 + stroke, pushed, posture).at(1.6 + stroke, pushed, posture);
  return script.at(2.8 + stroke, away, relaxed_posture()).motion();
}

ScriptedMotion tap() {
  constexpr double kSpeed = 0.5, kSwing = 40.0 * M_PI / 180.0;
  HandPosture touching = pointing_posture();
  touching.col(1) << 0.0, 0.1, 0.35, 0.2, 0.0;
  HandPosture raised = touching, lowered = touching;
  raised(kBaseFlexion, 1) -= 0.5 * kSwing;
  lowered(kBaseFlexion, 1) += 0.5 * kSwing;
  const auto finger = finger_joints(human_hand().fingers[1], touching.col(1));
  const double stroke = kPeakSpeed * kSwing * (finger[4] - finger[1]).norm() / kSpeed;
  // Pitch at which the tip is level with its knuckle on hitting the cube, so that it moves straight down.
  const Vector3 chord = finger[4] - finger[1];
  const double pitch = std::atan2(-chord.z(), chord.x());
  const Vector3 fingers(0.0, std::cos(pitch), std::sin(pitch)),
      dorsal(0.0, -std::sin(pitch), std::cos(pitch));
  const Pose at = wrist_for_index_tip(touching_tip(Vector3::UnitZ()),
                                      hand_pose(Vector3::Zero(), fingers, dorsal), touching);
  const Pose away = shifted(at, {0.06, -0.16, 0.06});
  Script script("cube");
  script.at(0.0, away, relaxed_posture()).at(1.0, at, raised).at(1.3, at, raised);
  script.at(1.3 + stroke, at, lowered).at(1.7 + stroke, at, raised).at(2.1 + stroke, at, raised);
  return script.at(3.1 + stroke, away, relaxed_posture()).motion();
}

ScriptedMotion slap() {
  constexpr double kSpeed = 1.5, kBefore = 0.26, kAfter = 0.26;
  const HandPosture posture = flat_posture();
  const Vector3 swing(-1.0, 0.0, 0.0);
  // The cube's centre is in front of the middle finger's knuckle; the hand is upright with the thumb up.
  const auto middle = finger_joints(human_hand().fingers[2], posture.col(2));
  const Pose direction = hand_pose(Vector3::Zero(), Vector3::UnitY(), -swing);
  const Vector3 meeting(middle[1].x() + 0.010, middle[1].y(), middle[1].z() - human_hand().fingers[2].radius);
  const Pose contact{scene_object() - kHalfCube * swing - direction.orientation * meeting,
                     direction.orientation};
  const Pose drawn = shifted(contact, -kBefore * swing), through = shifted(contact, kAfter * swing);
  const double stroke = kPeakSpeed * (kBefore + kAfter) / kSpeed;
  Script script("cube");
  script.at(0.0, shifted(drawn, {0.02, -0.10, 0.0}), relaxed_posture());
  script.at(0.8, drawn, posture).at(1.0, drawn, posture);
  script.at(1.0 + stroke, through, posture).at(1.4 + stroke, through, posture);
  return script.at(2.3 + stroke, shifted(through, {0.0, -0.12, -0.02}), relaxed_posture()).motion();
}

constexpr double kThumbOverlap = 0.006, kFingerOverlap = 0.003;  // of the tips beyond the surface [m]

/// Wrist pose for pointing away from the body, palm down.
Pose pointing_forward() {
  return hand_pose(Vector3::Zero(), {0.0, 1.0, -0.25}, {0.0, 0.25, 1.0});
}

/// Position of the index fingertip with its skin touching a surface at `point`.
Pose touching(const Vector3& point, const Vector3& normal) {
  const Vector3 tip = point + human_hand().fingers[1].radius * normal;
  return wrist_for_index_tip(tip, pointing_forward(), pointing_posture());
}

/// Thumb and two fingers on opposite sides of an upright bar, palm towards the panel, fingers to the right.
/// Its frame is world's at the bar's centre.
Grasp bar_grasp(double width) {
  const double x = 0.5 * width;
  const Vector3 right = Vector3::UnitX();
  return {hand_pose({-0.0443, -0.1067, -0.0186}, {0.878, 0.377, 0.296}, {0.311, -0.918, 0.246}),
          {{0, {-x, 0.0, 0.0}, -right, kThumbOverlap},
           {1, {x, 0.0, 0.009}, right, kFingerOverlap},
           {2, {x, 0.0, -0.009}, right, kFingerOverlap}},
          posture_of_degrees(
              {{25, 0, 0, 0, -4}, {5, 50, 50, 80, 80}, {15, 38, 38, 95, 95}, {30, 25, 25, 60, 60}, {35}}),
          0.014,
          -Vector3::UnitY()};
}

/// Fingers under a horizontal bar and the thumb on it, palm up.
Grasp rail_grasp(double width) {
  const double z = 0.5 * width;
  const Vector3 up = Vector3::UnitZ();
  return {hand_pose({0.001, -0.0759, -0.0371}, {0.278, 0.774, -0.568}, {0.399, -0.631, -0.665}),
          {{0, {0.0, 0.0, z}, up, kThumbOverlap},
           {1, {0.018, 0.0, -z}, -up, 0.002},
           {2, {0.0, 0.0, -z}, -up, 0.002},
           {3, {-0.018, 0.0, -z}, -up, 0.002}},
          shipped_grasp("flat_cuboid").preferred,
          0.015,
          -Vector3::UnitY()};
}

const Vector3 kBeside(0.03, -0.08, 0.03);  // start and end of the hand [m]

/// A fingertip that touches at `place`, moves on by `displacement` in `duration`, and returns.
Make push(const Vector3& place, const Vector3& normal, const Vector3& displacement, double duration) {
  return [=] {
    const Pose at = touching(place, normal), off = shifted(at, 0.03 * normal);
    const HandPosture posture = pointing_posture();
    Script script("panel");
    script.then(0.0, shifted(off, kBeside), relaxed_posture()).then(0.9, off, posture).hold(0.2);
    script.then(duration, shifted(at, displacement), posture).hold(0.4).then(0.8 * duration, off, posture);
    return script.then(0.9, shifted(off, kBeside), relaxed_posture()).motion();
  };
}

constexpr double kHatchFace = 0.115;  // a fingertip that rotates a latch is this far before the hatch [m]

/// The fingertip moves a latch, 45 mm from its axle, `up` or down by a quarter turn. Keyframes with
/// velocities every 30 degrees keep it on the arc.
void turn_latch(Script& script, const Vector3& axle, double up) {
  constexpr double kRadius = 0.04, kGapBelow = 0.006, kParts = 3.0, kAngle = M_PI / 2.0, kTime = 2.0;
  const double radius = human_hand().fingers[1].radius;
  const HandPosture posture = pointing_posture();
  const auto tip = [&](double angle, double under) {
    const double c = std::cos(angle), s = std::sin(angle);
    return Vector3(axle.x() + kRadius * c + under * s, kHatchFace, axle.z() + up * (kRadius * s - under * c));
  };
  const auto wrist = [&](double angle, double under) {
    return wrist_for_index_tip(tip(angle, under), pointing_forward(), posture);
  };
  const double touching = kGapBelow + radius, off = touching + 0.015;
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

/// Spacing of the fingers on an arm of tongs, over that on a cube.
constexpr double kTongsSpacing = 1.3;

/// Grasp of the arms of tongs at half their length, each arm at `angle` from the middle; in the frame of the
/// scene's object.
Grasp tongs_grasp(double angle) {
  Grasp grasp = shipped_grasp("cube");
  const double c = std::cos(angle), s = std::sin(angle);
  for (FingertipContact& contact : grasp.contacts) {
    contact.depth *= 1.7;  // the arms comply, and the grip with them
    const double side = contact.finger == 0 ? -1.0 : 1.0, along = 0.07 + kTongsSpacing * contact.point.x();
    contact.normal = {-s, side * c, 0.0};
    contact.point = Vector3(-0.07 + along * c, side * along * s, 0.0) + 0.004 * contact.normal;
  }
  return grasp;
}

/// Opens both latches, then the hatch by its handle.
ScriptedMotion open_hatch() {
  const Vector3 hinge(0.12, 0.14, 0.25);
  Script script("hatch");
  script.then(0.0, shifted(touching({-0.09, 0.02, 0.30}, -Vector3::UnitY()), kBeside), relaxed_posture());
  turn_latch(script, {-0.13, 0.123, 0.33}, 1.0);
  turn_latch(script, {-0.13, 0.123, 0.17}, -1.0);
  return GraspScript(script, bar_grasp(0.012), {-0.07, 0.10, 0.25})
      .take(kBeside)
      .hold(0.3)
      .turn_about(2.4, hinge, turn(60.0, Vector3::UnitZ()))
      .let_go({0.0, -0.03, 0.0});
}

ScriptedMotion squeeze_tongs() {
  const Grasp open_grasp = tongs_grasp(0.29);
  const GraspPostures half_squeezed(tongs_grasp(0.2)), squeezed(tongs_grasp(0.1));
  const Pose at = Pose{scene_object(), Quaternion::Identity()} * open_grasp.wrist;
  const Pose before = shifted(at, kApproachLength * open_grasp.retreat);
  const Vector3 aside(0.05, -kStartDistance, 0.02);
  GraspScript grip(Script("tongs"), open_grasp, scene_object());
  const GraspPostures& postures = grip.take(aside, kApproachLength, 0.15).postures();
  Script& script = grip.script();
  for (int squeeze = 0; squeeze < 2; ++squeeze)
    script.then(1.0, at, squeezed.closed).hold(0.3).then(1.0, at, half_squeezed.closed).hold(0.2);
  release(script.then(0.5, at, postures.closed), postures, at, before, open_grasp.retreat,
          shifted(before, aside));
  return script.motion();
}

/// A quarter turn by the upper arm.
ScriptedMotion turn_valve() {
  const Vector3 axle(0.01, 0.12, 0.34);
  GraspScript grip(Script("panel"), bar_grasp(0.014), axle + Vector3(0.0, 0.0, 0.031));
  grip.take(kBeside).hold(0.3).turn_about(1.6, axle, turn(60.0, Vector3::UnitY()));
  return grip.let_go(kBeside);
}

ScriptedMotion open_drawer() {
  GraspScript grip(Script("panel"), rail_grasp(0.012), {-0.13, 0.10, 0.15});
  return grip.take({0.0, -0.08, 0.0}).hold(0.3).slide(1.6, {0.0, -0.12, 0.0}).let_go({0.0, -0.03, 0.0});
}

ScriptedMotion open_door() {
  GraspScript grip(Script("panel"), bar_grasp(0.012), {0.075, 0.10, 0.17});
  grip.take(kBeside).hold(0.3).turn_about(2.0, {0.2, 0.14, 0.17}, turn(60.0, Vector3::UnitZ()));
  return grip.let_go({0.0, -0.03, 0.0});
}

struct MotionEntry {
  const char* name;
  Make make;
};
const MotionEntry kMotions[] = {
    {"grasp_cube", carry("cube", {0.05, -kStartDistance, 0.02})},
    {"grasp_ball", carry("ball", {0.05, -kStartDistance, 0.02})},
    {"catch_ball", catch_ball},
    {"pinch_long", carry("long_cuboid", {0.04, -kStartDistance, 0.0})},
    {"lift_flat", carry("flat_cuboid", {0.04, -kStartDistance + 0.08, -0.04})},
    {"nudge", nudge},
    {"tap", tap},
    {"slap", slap},
    {"press_button", push({-0.2, 0.12, 0.36}, -Vector3::UnitY(), {0.0, 0.012, 0.0}, 1.0)},
    // Pushes down the raised end, at 20 degrees.
    {"flip_switch", push({-0.11, 0.123, 0.3755}, Vector3::UnitZ(), {0.0, 0.0, -0.024}, 1.2)},
    {"turn_valve", turn_valve},
    {"pull_lever", push({0.16, 0.085, 0.368}, Vector3::UnitZ(), {0.0, 0.0, -0.03}, 1.2)},
    {"open_drawer", open_drawer},
    {"open_door", open_door},
    {"open_hatch", open_hatch},
    {"squeeze_tongs", squeeze_tongs}};

}  // namespace

ScriptedMotion reach_and_carry(const char* scene, const Grasp& grasp, const Vector3& object,
                               const Vector3& aside) {
  GraspScript grip(Script(scene), grasp, object);
  grip.take(aside, kApproachLength, 0.15).hold(0.4);
  carry_and_release(grip.script(), grasp, grip.postures(), object,
                    {{0.0, 0.0, 0.08}, turn(25.0, Vector3::UnitZ())}, aside);
  return grip.script().motion();
}

std::vector<std::string> motion_names() {
  return text::names_of(kMotions);
}

ScriptedMotion make_motion(const std::string& name) {
  const MotionEntry* const entry = text::find_named(kMotions, name);
  if (entry == nullptr)
    throw std::invalid_argument("motion '" + name + "' is not known: use one of " +
                                text::joined(motion_names()));
  ScriptedMotion motion = entry->make();
  motion.name = name;
  return motion;
}

}  // namespace mrhi
