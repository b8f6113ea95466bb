#pragma once

#include <functional>
#include <limits>
#include <optional>
#include <ostream>
#include <vector>

#include "support/grips.h"

namespace mrhi::testing {

/// A free 60 mm cube at 0 g between fingertips in two grids on opposite sides, the odd ones on the left. They
/// close in 0.2 s to 2 mm beyond its surface and sway by 10 mm at 3 Hz from 0.3 s to 0.8 s.
struct StabilityCell {
  ContactModelKind model;
  double mass;       // [kg]
  double step;       // [s]
  double stiffness;  // [N/m]
  int contacts;      // fingertips, 1 to 20
  double restitution;
  HandStrength hand{};  // the paper's
};

inline std::ostream& operator<<(std::ostream& out, const StabilityCell& cell) {
  return out << cell.mass << " kg, " << 1e3 * cell.step << " ms, " << cell.stiffness << " N/m, "
             << cell.contacts << " contacts, restitution " << cell.restitution;
}

enum class StabilityOutcome {
  stable,
  let_go,   ///< stable, but the cube slid through a grip whose friction carries twice what the sway asks for
  ejected,  ///< faster than anything that the hand does could make it
  diverged  ///< not a number any more, or faster or farther away than 100 m/s and 100 m
};

inline const char* to_string(StabilityOutcome outcome) {
  constexpr const char* kNames[] = {"stable", "let_go", "ejected", "diverged"};
  return kNames[static_cast<std::size_t>(outcome)];
}

struct StabilityResult {
  StabilityOutcome outcome;
  /// Of any of the cube's points against the hand, after any step [m/s]; a cell that diverges ends there.
  double largest_speed;
  double slid;  ///< how far the cube moved in the hand while it swayed, at most [m]
};

/// What is varied. A cell is one of each.
struct StabilityGrid {
  std::vector<double> masses, steps, stiffnesses;
  std::vector<int> contacts;
  std::vector<double> restitutions;

  template <class F>
  void for_every_cell(ContactModelKind model, F visit) const {
    for (const double mass : masses)
      for (const double step : steps)
        for (const double stiffness : stiffnesses)
          for (const int count : contacts)
            for (const double restitution : restitutions)
              visit(StabilityCell{model, mass, step, stiffness, count, restitution, {}});
  }
};

/// One cell, played from its start to its end.
class StabilityRun {
 public:
  static constexpr double kHalf = 0.03;                                 // of the cube [m]
  static constexpr double kGap = 0.005;                                 // at first [m]
  static constexpr double kOverlap = 0.002;                             // once closed [m]
  static constexpr double kClosing = 0.2, kSwayFrom = 0.3, kEnd = 0.8;  // [s]
  static constexpr double kAmplitude = 0.01, kFrequency = 3.0;          // of the sway [m], [Hz]
  static constexpr double kSwayAcceleration = 9.0;                      // at most, as it begins [m/s^2]
  /// The fingers close at up to 0.066 m/s and sway at up to 0.22 m/s; an elastic blow doubles that, and a
  /// cube thrown to and fro between two closing fingers gains at each. Nothing else may drive it faster
  /// [m/s].
  static constexpr double kEjected = 1.0;
  static constexpr double kDiverged = 100.0;  // [m/s], [m]
  /// The springs alone give by 0.8 mm where friction carries twice what is asked for [m].
  static constexpr double kSlid = kOverlap;

  using SceneChange = std::function<Scene(const Scene&)>;

  explicit StabilityRun(
      const StabilityCell& cell, const SceneChange& changed = [](const Scene& s) { return s; })
      : cell_(cell), simulation_(changed(scene_of(cell)), configuration_of(cell)) {
    // A frame is a whole number of steps, as near to 120 Hz as it can be: every step is as long as the cell
    // says.
    const auto step = static_cast<Nanoseconds>(std::llround(1e9 * cell.step));
    const double steps = std::round(1e9 / 120.0 / static_cast<double>(step));
    frame_ = step * std::max<Nanoseconds>(1, static_cast<Nanoseconds>(steps));
  }

  StabilityResult play() {
    StabilityResult result{StabilityOutcome::stable, 0.0, 0.0};
    std::optional<Vector3> held;
    for (Nanoseconds time = 0; to_seconds(time) < kEnd; time += frame_) {
      const double speed = largest_speed_in_frame(time);
      result.largest_speed = std::max(result.largest_speed, speed);
      if (result.largest_speed > kDiverged || has_event(simulation_, EventKind::out_of_bounds)) {
        result.outcome = StabilityOutcome::diverged;
        return result;
      }
      if (to_seconds(time) < kSwayFrom) continue;
      const Vector3 place = simulation_.state().bodies[0].pose.position - sway_;
      if (!held) held = place;
      result.slid = std::max(result.slid, (place - *held).norm());
    }
    if (result.largest_speed > kEjected)
      result.outcome = StabilityOutcome::ejected;
    else if (friction_suffices() && result.slid > kSlid)
      result.outcome = StabilityOutcome::let_go;
    return result;
  }

 private:
  static Scene scene_of(const StabilityCell& cell) {
    Body cube = stiff_box(Vector3::Constant(2.0 * kHalf), cell.mass, cell.stiffness);
    cube.material.restitution = cell.restitution;
    Scene scene = testing::scene_of(cube);
    scene.bounds = {Vector3::Constant(-kDiverged), Vector3::Constant(kDiverged)};
    return scene;
  }
  static Configuration configuration_of(const StabilityCell& cell) {
    Configuration configuration = unfiltered(cell.model);
    configuration.step = cell.step;
    configuration.contact.hand = cell.hand;
    return configuration;
  }
  static Vector3 sway_at(double t) {
    return smooth(t - kSwayFrom, 0.1) * swing(t - kSwayFrom, kAmplitude, kFrequency);
  }

  /// Infinite once anything is not a number.
  double largest_speed_in_frame(Nanoseconds time) {
    const Vector3 sway = sway_at(to_seconds(time));
    const Vector3 hand_velocity = (sway - sway_) / to_seconds(frame_);
    sway_ = sway;
    double largest = 0.0;
    simulation_.begin({kStart + time, {hand_at(to_seconds(time))}});
    while (simulation_.step()) {
      if (!finite(simulation_.state().bodies[0])) return std::numeric_limits<double>::infinity();
      const Twist twist = object_twist(simulation_);
      largest = std::max(largest, (twist.linear - hand_velocity).norm() + kHalf * twist.angular.norm());
    }
    simulation_.end();
    return largest;
  }

  Hand hand_at(double t) const {
    const double gap = kGap - (kGap + kOverlap) * smooth(t, kClosing);
    Hand hand = empty_hand();
    for (int i = 0; i < cell_.contacts; ++i) {
      const Vector3 outward(i % 2 == 0 ? 1.0 : -1.0, 0, 0);
      const int place = i / 2, count = (cell_.contacts + 1 - i % 2) / 2;
      const int columns = std::min(count, 4), rows = (count + columns - 1) / columns;
      const Vector3 across(0, 0.012 * (place % columns - 0.5 * (columns - 1)),
                           0.016 * (place / columns - 0.5 * (rows - 1)));
      add_fingertip(hand, i, (kHalf + gap) * outward + across + sway_, outward, 0.3, Vector3::UnitY());
    }
    return hand;
  }

  /// Friction of as many fingertips on each side carries the cube at twice the sway's acceleration.
  bool friction_suffices() const {
    const int pressing = 2 * (cell_.contacts / 2);
    const double friction = Material().static_friction * pressing * cell_.stiffness * kOverlap;
    return pressing > 0 && friction >= 2.0 * cell_.mass * kSwayAcceleration;
  }

  StabilityCell cell_;
  Simulation simulation_;
  Nanoseconds frame_;
  Vector3 sway_ = Vector3::Zero();
};

}  // namespace mrhi::testing
