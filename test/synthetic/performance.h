#pragma once

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/scene/scene_loader.h"
#include "mr_hand_interaction/simulation.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "support/white_noise.h"

namespace mrhi::testing {

struct Moment {
  double time;  // [s]
  Pose object;
  Twist twist;
  bool held;
  Pose palm;

  Pose in_hand() const { return palm.inverse() * object; }
};

/// What a motion is done with.
struct Staging {
  ContactModelKind model = ContactModelKind::implicit;
  std::string side = "right";
  double gravity = 0.0;       // along world's z [m/s^2]
  double gravity_from = 0.0;  // when it sets in: none of the shipped objects stands on anything [s]
  Body (*stand)(const Body&) = nullptr;       // makes what the object stands on
  double rate = SyntheticHandOptions().rate;  // of the tracker [1/s]
  double noise = 0.0;                         // white, on every joint by itself, rms on an axis [m]
  double correlation = 0.0;                   // of that noise from one frame to the next
  double dropped = 0.0;                       // share of the frames that do not come
  std::uint64_t seed = 1;
  FilterConfiguration filter;
};

/// The tracker of a staging: what comes of the frames that it sees.
class BadTracker {
 public:
  explicit BadTracker(const Staging& staging)
      : noise_(staging.noise, staging.seed, staging.correlation),
        luck_(staging.seed + 1),
        dropped_(staging.dropped) {}

  /// False if the frame does not come.
  bool pass(JointsFrame& frame) {
    for (HandJoints& hand : frame.hands) noise_.apply(hand);
    return frame.stamp == 0 || luck_.uniform() >= dropped_;
  }

 private:
  JointNoise noise_;
  Random luck_;
  double dropped_;
};

inline Scene staged_scene(const ScriptedMotion& motion, const Configuration& configuration,
                          Body (*stand)(const Body&) = nullptr) {
  SceneOptions options;
  options.default_material = default_material(configuration);
  Scene scene = load_scene(find_scene_file(motion.scene, {"config/scenes"}), options);
  scene.bodies.at(0).start_twist = motion.object_twist;
  if (stand != nullptr) scene.bodies.push_back(stand(scene.bodies[0]));
  return scene;
}

/// One run of a motion on its shipped scene, as a user meets it (default filter and step); a moment for each
/// frame with a hand in it.
inline std::vector<Moment> perform(const std::string& motion, const Staging& staging) {
  SyntheticHandOptions options;
  options.motion = motion;
  options.side = staging.side;
  options.rate = staging.rate;
  SyntheticHand source(options);
  BadTracker tracker(staging);
  Configuration configuration;
  configuration.filter = staging.filter;
  configuration.contact_model = staging.model;
  configuration.gravity = Vector3::Zero();
  const Scene scene = staged_scene(source.motion(), configuration, staging.stand);
  Simulation weightless(scene, configuration);
  configuration.gravity = Vector3(0.0, 0.0, staging.gravity);
  Simulation heavy(scene, configuration);
  bool is_heavy = false;
  std::vector<Moment> moments;
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
    const Rejection rejection = simulation.advance(frame);
    if (rejection == Rejection::stamp_ahead) continue;  // the first one after many that were dropped
    if (rejection != Rejection::none) throw std::runtime_error("frame refused");
    if (frame.hands.empty()) break;
    const BodyState& body = simulation.state().bodies.at(0);
    moments.push_back({time, body.pose, twist_of(simulation.scene().bodies.at(0), body),
                       simulation.state().interactions.at(0).level == InteractionLevel::grasp,
                       simulation.result().tracked.at(0).palm});
  }
  return moments;
}

/// When a grasping motion begins to carry the object, and when it begins to open the hand [s].
inline double carrying_from(const ScriptedMotion& motion) {
  return motion.keyframes.at(motion.keyframes.size() - 7).time;
}
inline double opening_from(const ScriptedMotion& motion) {
  return motion.keyframes.at(motion.keyframes.size() - 5).time;
}

inline const Moment& moment_at(const std::vector<Moment>& moments, double time) {
  const auto found = std::find_if(moments.begin(), moments.end(),
                                  [time](const Moment& moment) { return moment.time >= time; });
  return found == moments.end() ? moments.back() : *found;
}

/// Held from when it is carried until the hand opens, without a break.
inline bool held_throughout(const std::vector<Moment>& moments, double from, double to) {
  return std::all_of(moments.begin(), moments.end(), [&](const Moment& moment) {
    return moment.held || moment.time < from || moment.time > to;
  });
}

/// How far the object is moved in the palm, from when it is carried until the hand opens: [m] and [rad].
struct Shift {
  double way, turn;
};
inline Shift shift_in_hand(const std::vector<Moment>& moments, double from, double to) {
  const Pose before = moment_at(moments, from).in_hand(), after = moment_at(moments, to).in_hand();
  return {(after.position - before.position).norm(), before.orientation.angularDistance(after.orientation)};
}

/// Greatest velocity that the object gets from a strike.
inline Vector3 struck_velocity(const std::string& motion, const Staging& staging) {
  Vector3 fastest = Vector3::Zero();
  for (const Moment& moment : perform(motion, staging)) {
    if (moment.twist.linear.norm() > fastest.norm()) fastest = moment.twist.linear;
  }
  return fastest;
}

}  // namespace mrhi::testing
