#include "motions.h"
#include "script.h"
#include "scripted_grasp.h"

namespace mrhi {
namespace {

constexpr double kApproach = 0.10;  // [m] straight to the object with the hand open
constexpr double kAside = 0.16;     // [m] further away, where the hand comes from

/// Carries the object, held with its centre at `centre`, to another pose, holds it, lets go and withdraws.
void carry_and_release(Script& script, const Grasp& grasp, const GraspPostures& postures,
                       const Vector3& centre, const Pose& carried, const Vector3& aside) {
  const Pose target = Pose{centre, Quaternion::Identity()} * carried;
  const Pose wrist = target * grasp.wrist;
  const Vector3 retreat = carried.orientation * grasp.retreat;
  script.then(1.4, wrist, postures.pressing).hold(0.6);
  script.then(0.7, wrist, postures.near).by_way_of(postures.touching, 1.0 - postures.touching_share);
  script.then(0.5, wrist, postures.open);
  script.then(0.7, shifted(wrist, kApproach * retreat), postures.open, 0.1 * retreat);
  script.then(0.8, shifted(wrist, kApproach * retreat + aside), relaxed_posture());
}

ScriptedMotion reach_and_carry(const char* object, const Vector3& aside) {
  return reach_and_carry(object, shipped_grasp(object), scene_object(), aside);
}

}  // namespace

ScriptedMotion reach_and_carry(const char* scene, const Grasp& grasp, const Vector3& object,
                               const Vector3& aside) {
  const GraspPostures postures(grasp);
  const Pose at = Pose{object, Quaternion::Identity()} * grasp.wrist;
  const Pose before = shifted(at, kApproach * grasp.retreat);
  Script script(scene);
  script.then(0.0, shifted(before, aside), relaxed_posture());
  script.then(0.9, before, postures.open, -0.15 * grasp.retreat);
  script.then(0.8, at, postures.open);
  script.then(0.6, at, postures.near);
  script.then(0.7, at, postures.pressing).by_way_of(postures.touching, postures.touching_share);
  script.hold(0.4);
  carry_and_release(script, grasp, postures, object, {{0.0, 0.0, 0.08}, turn(25.0, Vector3::UnitZ())}, aside);
  return script.motion();
}

ScriptedMotion grasp_cube() {
  return reach_and_carry("cube", {0.05, -kAside, 0.02});
}

ScriptedMotion grasp_ball() {
  return reach_and_carry("ball", {0.05, -kAside, 0.02});
}

ScriptedMotion catch_ball() {
  constexpr double kMeet = 0.7, kClose = 0.3, kPress = 0.4, kStop = 0.5, kStart = 0.4;  // [s]
  const Vector3 velocity(0.0, -0.3, 0.0);
  const Grasp grasp = shipped_grasp("ball").turned(turn(90.0, Vector3::UnitX()));
  const GraspPostures postures(grasp);
  const auto wrist_round = [&](const Vector3& ball) {
    return Pose{ball, Quaternion::Identity()} * grasp.wrist;
  };
  const Vector3 met = scene_object() + kMeet * velocity;
  const Vector3 near = met + kClose * velocity, closed = near + kPress * velocity;
  const Vector3 stopped = closed + 0.5 * kStop * velocity;
  Script script("ball");
  script.object_twist({velocity, Vector3::Zero()});
  script.then(0.0, wrist_round(met - 0.5 * kStart * velocity), postures.open).hold(kMeet - kStart);
  script.then(kStart, wrist_round(met), postures.open, velocity);
  script.then(kClose, wrist_round(near), postures.near, velocity);
  script.then(kPress, wrist_round(closed), postures.pressing, velocity);
  script.by_way_of(postures.touching, postures.touching_share);
  script.then(kStop, wrist_round(stopped), postures.pressing).hold(0.3);
  const Pose carried{{0.0, 0.08, 0.06}, turn(20.0, Vector3::UnitX())};
  carry_and_release(script, grasp, postures, stopped, carried, {0.08, 0.0, -0.05});
  return script.motion();
}

ScriptedMotion pinch_long() {
  return reach_and_carry("long_cuboid", {0.04, -kAside, 0.0});
}

ScriptedMotion lift_flat() {
  return reach_and_carry("flat_cuboid", {0.04, -kAside + 0.08, -0.04});
}

}  // namespace mrhi
