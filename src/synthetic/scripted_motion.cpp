#include "mr_hand_interaction/synthetic/scripted_motion.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "../math/minimum_jerk.h"
#include "motions.h"

namespace mrhi {
namespace {

struct MotionEntry {
  const char* name;
  ScriptedMotion (*make)();
};
constexpr MotionEntry kMotions[] = {{"grasp_cube", grasp_cube},
                                    {"grasp_ball", grasp_ball},
                                    {"catch_ball", catch_ball},
                                    {"pinch_long", pinch_long},
                                    {"lift_flat", lift_flat},
                                    {"nudge", nudge},
                                    {"tap", tap},
                                    {"slap", slap},
                                    {"press_button", press_button},
                                    {"flip_switch", flip_switch},
                                    {"turn_valve", turn_valve},
                                    {"pull_lever", pull_lever},
                                    {"open_drawer", open_drawer},
                                    {"open_door", open_door},
                                    {"open_hatch", open_hatch},
                                    {"squeeze_tongs", squeeze_tongs}};

/// Parabola through the postures at the shares 0, via_share and 1 of the way.
HandPosture posture_between(const Keyframe& from, const Keyframe& to, double share) {
  const HandPosture straight = from.posture + share * (to.posture - from.posture);
  if (to.via_share <= 0.0) return straight;
  const double v = to.via_share;
  const HandPosture bow = to.via - from.posture - v * (to.posture - from.posture);
  return straight + share * (1.0 - share) / (v * (1.0 - v)) * bow;
}

/// Both turned about the centre by the same share of the turn that the ends differ by.
Pose on_arc(const Keyframe& from, const Keyframe& to, double share) {
  const Quaternion turn = to.wrist.orientation * from.wrist.orientation.conjugate();
  const Quaternion part = Quaternion::Identity().slerp(share, turn);
  const Vector3 arm = from.wrist.position - *to.centre;
  return {*to.centre + part * arm, (part * from.wrist.orientation).normalized()};
}

/// Left hand's frame for what a right hand does, mirrored in world's x.
Pose mirrored(const Pose& wrist) {
  const Quaternion& q = wrist.orientation;
  const Quaternion half_turn(0.0, 0.0, 0.0, 1.0);
  return {Vector3(-wrist.position.x(), wrist.position.y(), wrist.position.z()),
          Quaternion(q.w(), q.x(), -q.y(), -q.z()) * half_turn};
}

}  // namespace

HandPlace hand_at(const std::vector<Keyframe>& keys, double time) {
  const auto after = [](double t, const Keyframe& key) { return t < key.time; };
  const auto next = std::upper_bound(keys.begin(), keys.end(), time, after);
  if (next == keys.end()) return {keys.back().wrist, keys.back().posture};
  if (next == keys.begin()) return {keys.front().wrist, keys.front().posture};
  const Keyframe &from = *(next - 1), &to = *next;
  const double duration = to.time - from.time;
  const double t = (time - from.time) / duration;
  const double share = minimum_jerk(t);
  if (to.centre) return {on_arc(from, to, share), posture_between(from, to, share)};
  const Pose wrist{
      minimum_jerk(from.wrist.position, from.velocity, to.wrist.position, to.velocity, duration, t),
      from.wrist.orientation.slerp(share, to.wrist.orientation).normalized()};
  return {wrist, posture_between(from, to, share)};
}

std::vector<std::string> motion_names() {
  std::vector<std::string> names;
  for (const MotionEntry& entry : kMotions) names.emplace_back(entry.name);
  return names;
}

ScriptedMotion make_motion(const std::string& name) {
  std::string known;
  for (const MotionEntry& entry : kMotions) {
    if (name == entry.name) {
      ScriptedMotion motion = entry.make();
      motion.name = name;
      return motion;
    }
    known += std::string(known.empty() ? "" : ", ") + entry.name;
  }
  throw std::invalid_argument("motion '" + name + "' is not known: use one of " + known);
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
