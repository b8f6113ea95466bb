#include "mr_hand_interaction/synthetic/scripted_motion.h"

#include <algorithm>
#include <cmath>

#include "../math/minimum_jerk.h"
#include "motions.h"

namespace mrhi {
namespace {

/// Parabola through the postures at the fractions 0, via_share and 1 of the path.
HandPosture posture_between(const Keyframe& from, const Keyframe& to, double fraction) {
  const HandPosture straight = from.posture + fraction * (to.posture - from.posture);
  if (to.via_share <= 0.0) return straight;
  const double v = to.via_share;
  const HandPosture bow = to.via - from.posture - v * (to.posture - from.posture);
  return straight + fraction * (1.0 - fraction) / (v * (1.0 - v)) * bow;
}

/// Rotates position and orientation about the centre by the same fraction of the rotation between both ends.
Pose on_arc(const Keyframe& from, const Keyframe& to, double fraction) {
  const Quaternion turn = to.wrist.orientation * from.wrist.orientation.conjugate();
  const Quaternion part = Quaternion::Identity().slerp(fraction, turn);
  const Vector3 arm = from.wrist.position - *to.centre;
  return {*to.centre + part * arm, (part * from.wrist.orientation).normalized()};
}

}  // namespace

Pose mirrored(const Pose& wrist) {
  const Quaternion& q = wrist.orientation;
  const Quaternion half_turn(0.0, 0.0, 0.0, 1.0);
  return {Vector3(-wrist.position.x(), wrist.position.y(), wrist.position.z()),
          Quaternion(q.w(), q.x(), -q.y(), -q.z()) * half_turn};
}

std::vector<Keyframe> shifted(std::vector<Keyframe> keyframes, const Vector3& by) {
  for (Keyframe& key : keyframes) {
    key.wrist.position += by;
    if (key.centre) *key.centre += by;
  }
  return keyframes;
}

Pose hand_pose(const Vector3& wrist, const Vector3& fingers, const Vector3& dorsal) {
  Matrix3 axes;
  axes.col(0) = fingers.normalized();
  axes.col(1) = dorsal.cross(fingers).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return {wrist, Quaternion(axes)};
}

Pose wrist_for_index_tip(const Vector3& tip, const Pose& direction, const HandPosture& posture) {
  const Vector3 in_hand = finger_joints(human_hand().fingers[1], posture.col(1))[4];
  return {tip - direction.orientation * in_hand, direction.orientation};
}

Quaternion turn(double degrees, const Vector3& axis) {
  return Quaternion(Eigen::AngleAxisd(degrees * M_PI / 180.0, axis));
}

HandPlace hand_at(const std::vector<Keyframe>& keys, double time) {
  const auto after = [](double t, const Keyframe& key) { return t < key.time; };
  const auto next = std::upper_bound(keys.begin(), keys.end(), time, after);
  if (next == keys.end()) return {keys.back().wrist, keys.back().posture};
  if (next == keys.begin()) return {keys.front().wrist, keys.front().posture};
  const Keyframe &from = *(next - 1), &to = *next;
  const double duration = to.time - from.time;
  const double t = (time - from.time) / duration;
  const double fraction = minimum_jerk(t);
  if (to.centre) return {on_arc(from, to, fraction), posture_between(from, to, fraction)};
  const Pose wrist{
      minimum_jerk(from.wrist.position, from.velocity, to.wrist.position, to.velocity, duration, t),
      from.wrist.orientation.slerp(fraction, to.wrist.orientation).normalized()};
  const HandPosture still = HandPosture::Zero();
  return {wrist,
          posture_between(from, to, fraction) + minimum_jerk(still, from.rate, still, to.rate, duration, t)};
}

Pose default_device_mount() {
  return {Vector3::Zero(), Quaternion(Eigen::AngleAxisd(M_PI / 2.0, Vector3::UnitX()))};
}

JointsFrame sample(const ScriptedMotion& motion, Side side, Nanoseconds time, const Pose& device_in_world) {
  JointsFrame frame;
  frame.stamp = time;
  const auto period = static_cast<Nanoseconds>(std::llround(1e9 * motion.period()));
  const Nanoseconds run = time / period;
  const double in_run = to_seconds(time - run * period);
  if (time < 0 || in_run > motion.run_time()) return frame;
  const auto [wrist, posture] = hand_at(motion.keyframes, in_run);
  const Pose in_world = side == Side::left ? mirrored(wrist) : wrist;
  frame.hands.push_back(hand_joints(human_hand(), side, device_in_world.inverse() * in_world, posture));
  frame.hands.back().id = static_cast<std::uint32_t>(run + 1);
  return frame;
}

}  // namespace mrhi
