#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "mr_hand_interaction/synthetic/random.h"
#include "mr_hand_interaction/synthetic/synthetic_hand.h"
#include "operators_at_work.h"

namespace mrhi::testing {

/// How the hand goes to an object, as it is measured of people: from when it is faster than 5 cm/s until it
/// is slower again.
struct ReachFigures {
  double duration = 0.0;       ///< [s]
  double widest_at = 0.0;      ///< when thumb and index finger are farthest apart, share of the duration
  double fastest_at = 0.0;     ///< likewise
  double closed_before = 0.0;  ///< share of what the hand closes by that is done before its end
  int speed_peaks = 0;         ///< that stand out by a tenth of the greatest speed
};

/// How it holds what it holds.
struct GripFigures {
  std::vector<double> grip, load;  ///< frame by frame [N]
  double mean() const { return mean_of(grip); }
  double mean_load() const { return mean_of(load); }
  double quantile(double share) const {
    std::vector<double> sorted = grip;
    std::sort(sorted.begin(), sorted.end());
    return sorted.empty() ? 0.0
                          : sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  }
  /// Pearson's of grip and load at the same time.
  double correlation() const {
    const double g = mean(), l = mean_load();
    double gl = 0.0, gg = 0.0, ll = 0.0;
    for (std::size_t i = 0; i < grip.size(); ++i) {
      gl += (grip[i] - g) * (load[i] - l);
      gg += (grip[i] - g) * (grip[i] - g);
      ll += (load[i] - l) * (load[i] - l);
    }
    return gl / std::sqrt(gg * ll);
  }
  /// Share of the mean grip that is beyond what would just not slip between two sides.
  double safety_margin(double friction) const { return 1.0 - mean_load() / (2.0 * friction) / mean(); }

 private:
  static double mean_of(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values) sum += value / static_cast<double>(values.size());
    return sum;
  }
};

/// What an operator is watched at: an object of a mass, at a gravity, swung to and fro or carried to a place.
struct Watched {
  std::string object = "cube", group = "veteran", model = "implicit";
  std::uint64_t person = 1;
  double gravity = 0.0;  ///< [m/s^2]
  double mass = 0.0;     ///< 0: its own [kg]
  double swing = 0.0;    ///< from end to end [m]
  double noise = 0.0;    ///< of the tracker: amplitude of TrackingNoise
  bool help = false;     ///< grasp_assist, which bears what slips, so that its contacts tell no grip
};

class OperatorWatch {
 public:
  explicit OperatorWatch(const Watched& watched) : watched_(watched), seeds_(watched.person) {
    task_ = task_with(watched.object);
    task_.gravity = Vector3(0.0, 0.0, -watched.gravity);
    set_parameter(stage_.configuration, "contact_model", watched.model);
    set_parameter(stage_.configuration, "contact/grasp_assist", watched.help ? "true" : "false");
    stage_.configuration.gravity = task_.gravity;
    stage_.scene_folders = {"config/scenes"};
    stage_.scene_options.default_material = default_material(stage_.configuration);
    scene_ = operator_scene(task_, task_.objects.front(), stage_);
    scene_.bounds.max.array() += 1.0;
    if (watched.mass > 0.0) {
      Body& body = scene_.bodies.front();
      body.inertia *= watched.mass / body.mass;
      body.mass = watched.mass;
    }
    watch();
  }

  const ReachFigures& reach() const { return reach_; }
  const GripFigures& grip() const { return grip_; }
  double friction() const { return scene_.bodies.front().material.static_friction; }
  bool lost_while_swinging() const { return lost_; }

 private:
  static constexpr double kRate = 115.0, kSettled = 3.0, kHeld = 6.0;  // [Hz], [s] after the grasp

  void watch() {
    Simulation simulation(scene_, stage_.configuration);
    const OperatorSkill skill = draw_skill(watched_.group, seeds_.bits());
    SimulatedOperator person(skill, scene_.bodies.front(), seeds_.bits());
    TrackingNoise noise(watched_.noise, seeds_.bits());
    std::vector<double> aperture;
    std::vector<Vector3> wrist, velocity;
    double grasped = -1.0;
    for (int n = 0; n < 40 * kRate; ++n) {
      const double time = n / kRate;
      const BodyState& state = simulation.state().bodies.front();
      const Twist twist = twist_of(scene_.bodies.front(), state);
      const bool held = is_held(0, simulation.state());
      Sight sight = sight_of(task_, 1, state.pose, twist, held);
      sight.place = scene_.bodies.front().start.position + Vector3(0.0, 0.02, 0.5 * watched_.swing + 0.1);
      sight.swing = watched_.swing * Vector3::UnitZ();
      sight.grip = *observe(simulation, 0).grip_force;
      const HandPlace hand = person.move(time, sight);
      JointsFrame joints{static_cast<Nanoseconds>(std::llround(1e9 * time)),
                         {hand_joints(human_hand(), Side::right, hand.wrist, hand.posture)}};
      if (grasped < 0.0) {
        wrist.push_back(hand.wrist.position);
        aperture.push_back((tip(hand, 0) - tip(hand, 1)).norm());
      }
      noise.apply(joints);
      simulation.advance({joints.stamp, {complete_hand(joints.hands.front(), Pose{})}});
      if (grasped < 0.0 && person.phase() == SimulatedOperator::Phase::carrying) grasped = time;
      if (grasped < 0.0) continue;
      if (time > grasped + kSettled + kHeld) break;
      if (time < grasped + kSettled) continue;
      lost_ |= !held;
      velocity.push_back(twist.linear);
      grip_.grip.push_back(sight.grip);
    }
    measure_reach(wrist, aperture);
    measure_load(velocity);
  }

  static Vector3 tip(const HandPlace& hand, int finger) {
    return finger_joints(human_hand().fingers[static_cast<std::size_t>(finger)], hand.posture.col(finger))[4];
  }

  /// Mean of 11 frames, 0.1 s: as a low-pass filter of measurements.
  template <class Value>
  static std::vector<Value> smooth(const std::vector<Value>& values) {
    constexpr int kHalf = 5;
    const int size = static_cast<int>(values.size());
    std::vector<Value> result;
    for (int i = 0; i < size; ++i) {
      const int from = std::max(0, i - kHalf), to = std::min(size - 1, i + kHalf);
      Value sum = values[static_cast<std::size_t>(from)];
      for (int j = from + 1; j <= to; ++j) sum += values[static_cast<std::size_t>(j)];
      result.push_back(sum / static_cast<double>(to - from + 1));
    }
    return result;
  }

  void measure_reach(const std::vector<Vector3>& wrist, const std::vector<double>& aperture) {
    constexpr double kMoves = 0.05;  // [m/s]
    const std::vector<Vector3> path = smooth(wrist);
    std::vector<double> speed{0.0};
    for (std::size_t i = 1; i < path.size(); ++i) speed.push_back((path[i] - path[i - 1]).norm() * kRate);
    std::size_t begin = 0, end = 0;
    while (begin < speed.size() && speed[begin] < kMoves) ++begin;
    for (end = begin; end + 1 < speed.size() && speed[end + 1] >= kMoves;) ++end;
    const auto span = static_cast<double>(end - begin);
    const auto at = [&](const std::vector<double>& values) {
      const auto from = values.begin() + static_cast<std::ptrdiff_t>(begin);
      const auto last = values.begin() + static_cast<std::ptrdiff_t>(end + 1);
      return static_cast<std::size_t>(std::max_element(from, last) - values.begin());
    };
    reach_.duration = span / kRate;
    reach_.widest_at = static_cast<double>(at(aperture) - begin) / span;
    reach_.fastest_at = static_cast<double>(at(speed) - begin) / span;
    const double widest = aperture[at(aperture)];
    reach_.closed_before = (widest - aperture[end]) / (widest - aperture.back());
    reach_.speed_peaks = peaks({speed.begin() + static_cast<std::ptrdiff_t>(begin),
                                speed.begin() + static_cast<std::ptrdiff_t>(end + 1)});
  }

  static int peaks(const std::vector<double>& speed) {
    const double outstanding = 0.1 * *std::max_element(speed.begin(), speed.end());
    int count = 0;
    double extreme = speed.front();
    bool rising = true;
    for (const double value : speed) {
      extreme = rising ? std::max(extreme, value) : std::min(extreme, value);
      if (std::abs(value - extreme) < outstanding) continue;
      count += rising;
      rising = !rising;
      extreme = value;
    }
    return count + rising;
  }

  void measure_load(const std::vector<Vector3>& measured) {
    const std::vector<Vector3> velocity = smooth(measured);
    for (std::size_t i = 0; i < velocity.size(); ++i) {
      const std::size_t before = i == 0 ? 0 : i - 1, after = std::min(i + 1, velocity.size() - 1);
      const Vector3 acceleration =
          (velocity[after] - velocity[before]) * kRate / static_cast<double>(after - before);
      grip_.load.push_back(scene_.bodies.front().mass * (acceleration - task_.gravity).norm());
    }
    grip_.grip = smooth(grip_.grip);
  }

  Watched watched_;
  Random seeds_;
  Task task_;
  OperatorStage stage_;
  Scene scene_;
  ReachFigures reach_;
  GripFigures grip_;
  bool lost_ = false;
};

}  // namespace mrhi::testing
