#pragma once

#include <cmath>

#include "synthetic/performance.h"

namespace mrhi::testing {

/// A motion that works a joint: which, and how far the hand takes it.
struct Work {
  const char* motion;
  const char* joint;
  double to;       // where the hand leaves it, or the furthest that a push has it [rad, m]
  double left;     // where it is at the end of the run
  double within;   // of both [rad, m]
  bool grips;      // takes hold of it; else it pushes
  double fastest;  // that the joint may ever be [rad/s, m/s]
};

/// Peaks of minimum jerk are 1.875 times the mean: 60 degrees in 1.6 s, 2 s and 2.4 s, 120 mm in 1.6 s. A
/// switch snaps, a button and tongs spring back, by themselves. Within a frame the path of a hand whose
/// samples tremble is up to 1.5 times as fast as its chord: the valve reaches 3.2 rad/s with 3 mm of noise.
inline const std::vector<Work>& works() {
  static const std::vector<Work> all = {
      {"press_button", "button_slide", 0.006, 0.0, 1e-4, false, 0.3},
      {"flip_switch", "switch_hinge", 0.4, 0.35, 0.03, false, 40.0},
      {"pull_lever", "lever_hinge", 0.46, 0.46, 0.15, false, 6.0},
      {"turn_valve", "valve_axle", M_PI / 3.0, M_PI / 3.0, 0.15, true, 3.5},
      {"open_drawer", "drawer_slide", 0.12, 0.12, 0.01, true, 0.5},
      {"open_door", "door_hinge", M_PI / 3.0, M_PI / 3.0, 0.1, true, 3.0},
      {"open_hatch", "hatch_hinge", M_PI / 3.0, M_PI / 3.0, 0.1, true, 3.0},
      {"squeeze_tongs", "tongs_hinge", 0.13, 0.58, 0.06, true, 5.0},
  };
  return all;
}

/// What became of a run.
struct Worked {
  double furthest = 0.0, left = 0.0;  // where it was at the hand's turning point, and at the end [rad, m]
  double lag = 0.0;                   // most by which the joint was off the hand that has it [rad, m]
  double fastest = 0.0;               // [rad/s, m/s]
  double crept = 0.0;                 // by the time the hand is gone, since the hand left it [rad, m]
  double moved_before = 0.0;          // before the hand had come [rad, m]
  bool held = true;                   // from when it is moved until the hand opens, without a break
  bool finite = true;
  int limits = 0, clicks = 0, opened = 0;
};

/// How far a joint's hand has come since `from`: the turn about the arc's centre, or the way.
inline double hand_way(const ScriptedMotion& motion, double from, double time) {
  const Pose a = hand_at(motion.keyframes, from).wrist, b = hand_at(motion.keyframes, time).wrist;
  const double turned = a.orientation.angularDistance(b.orientation);
  return turned > 0.01 ? turned : (b.position - a.position).norm();
}

/// When a gripping motion begins to move the joint, when it has moved it, and when it opens the hand [s].
struct Moving {
  double from = 0.0, to = 0.0, opens = 0.0;
};
inline Moving moving(const ScriptedMotion& motion) {
  Moving result;
  const auto& keys = motion.keyframes;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    if (keys[i].via_share <= 0.0) continue;
    if (result.from == 0.0) {
      result.from = keys[i + 1].time;
      result.to = keys[i + 2].time;
    } else {
      result.opens = keys[i - 1].time;
    }
  }
  return result;
}

/// One run of a working motion as a user meets it (default filter and step); gravity sets in as its staging
/// says.
inline Worked work_at(const Work& work, const Staging& staging) {
  SyntheticHandOptions options;
  options.motion = work.motion;
  options.rate = staging.rate;
  SyntheticHand source(options);
  BadTracker tracker(staging);
  const ScriptedMotion& motion = source.motion();
  const Moving times = moving(motion);
  Configuration configuration;
  configuration.contact_model = staging.model;
  configuration.gravity = Vector3::Zero();
  const Scene scene = staged_scene(motion, configuration);
  Simulation weightless(scene, configuration);
  configuration.gravity = Vector3(0.0, 0.0, staging.gravity);
  Simulation heavy(scene, configuration);
  const auto joint = static_cast<std::size_t>(*find_joint(scene, work.joint));
  const auto body = static_cast<std::size_t>(scene.joints[joint].child);
  const double start = scene.joints[joint].start, away = motion.keyframes.at(1).time;
  const double gone = motion.keyframes.at(motion.keyframes.size() - 2).time;
  Worked result;
  bool is_heavy = false;
  double last = start, when_gone = start;
  while (source.next_run() == 0) {
    JointsFrame joints = source.next();
    if (!joints.hands.empty() && staging.noise + staging.dropped > 0.0 && !tracker.pass(joints)) continue;
    const double time = to_seconds(joints.stamp);
    HandFrame frame{joints.stamp, {}};
    for (const HandJoints& hand : joints.hands)
      frame.hands.push_back(complete_hand(hand, default_device_mount()));
    if (!is_heavy && time >= staging.gravity_from) {
      heavy.set_state(weightless.state());
      is_heavy = true;
    }
    Simulation& simulation = is_heavy ? heavy : weightless;
    if (simulation.advance(frame) != Rejection::none) continue;
    for (const Event& event : simulation.result().events) {
      result.limits += event.kind == EventKind::joint_limit;
      result.clicks += event.kind == EventKind::detent;
      result.opened += event.kind == EventKind::latch_open;
    }
    const double position = simulation.state().joints[joint].position;
    result.finite = result.finite && std::isfinite(position) && simulation.result().not_finite.empty();
    result.fastest = std::max(result.fastest,
                              std::abs(joint_velocity(simulation.scene(), joint, simulation.state().bodies)));
    if (time < away) result.moved_before = std::max(result.moved_before, std::abs(position - start));
    if (work.grips && time <= times.to) result.furthest = position;
    if (!work.grips && std::abs(position - start) > std::abs(result.furthest - start))
      result.furthest = position;
    const bool turns = times.from > 0.0 && hand_way(motion, times.from, times.to) > 0.0;
    if (turns && time > times.from && time < times.opens)
      result.lag = std::max(result.lag, std::abs(position - start - hand_way(motion, times.from, time)));
    if (work.grips && time > times.from && time < times.opens)
      result.held = result.held && simulation.state().interactions.at(body).level == InteractionLevel::grasp;
    if (time <= gone) when_gone = position;
    last = position;
  }
  result.left = last;
  result.crept = std::abs(last - when_gone);
  return result;
}

}  // namespace mrhi::testing
