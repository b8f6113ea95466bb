#pragma once

#include <algorithm>

#include "mr_hand_interaction/response/contact_model.h"
#include "support/pinch_scene.h"

namespace mrhi::testing {

/// A fingertip that lies on the plane z along x, 20 mm from end to end of its axis.
inline Hand lying(double x, double z, double radius = 0.008) {
  return finger(Vector3(x - 0.01, 0, z + radius), Vector3(x + 0.01, 0, z + radius), radius);
}

/// The pinch of scene (a) with the stiffness that `model` has by default, and what it does under that model.
/// A frame per step, so that every step can be looked at.
class PinchedCube {
 public:
  static constexpr double kRate = 1000.0;  // frames and steps a second

  explicit PinchedCube(ContactModelKind model, const Vector3& gravity = Vector3::Zero(),
                       double overlap = 0.002)
      : simulation_(scene_of(model, overlap), configuration_of(model, gravity)) {
    pinch_.overlap = overlap;
  }

  /// Goes on to `until` [s]; `way(t)` is where the hand is, `each` sees every step.
  void play(double until, const std::function<Vector3(double)>& way,
            const std::function<void()>& each = nullptr) {
    for (; frame_ <= std::lround(until * kRate); ++frame_) {
      const double t = static_cast<double>(frame_) / kRate;
      simulation_.advance({at(t), {opened(pinch_.hand(t, way(t)), way(t), t)}});
      if (each) each();
    }
  }
  void hold(double until, const std::function<void()>& each = nullptr) {
    play(
        until, [](double) -> Vector3 { return Vector3::Zero(); }, each);
  }
  /// From `t` on thumb and fingers part, each at `speed` in the end.
  void open_at(double t, double speed) { open_ = t, open_speed_ = speed; }

  const Simulation& simulation() const { return simulation_; }
  const Body& body() const { return simulation_.scene().bodies[0]; }
  const BodyState& cube() const { return simulation_.state().bodies[0]; }
  void push(const Vector3& impulse) {
    SimulationState state = simulation_.state();
    state.bodies[0].linear_momentum += impulse;
    simulation_.set_state(state);
  }
  double energy() const { return kinetic_energy(body(), cube()); }

  static Configuration configuration_of(ContactModelKind model, const Vector3& gravity) {
    Configuration configuration = unfiltered(model);
    configuration.step = 1.0 / kRate;
    configuration.gravity = gravity;
    return configuration;
  }

 private:
  static Scene scene_of(ContactModelKind model, double overlap) {
    PinchScene pinch;
    pinch.overlap = overlap;
    pinch.stiffness = default_material(unfiltered(model)).stiffness;
    return pinch.scene();
  }
  Hand opened(Hand hand, const Vector3& sway, double t) const {
    const double gap = open_speed_ * std::max(0.0, t - open_);
    for (Capsule& capsule : hand.capsules) {
      if (capsule.radius <= 0.0) continue;
      const Vector3 apart((capsule.start - sway).x() > 0.0 ? gap : -gap, 0, 0);
      capsule.start += apart, capsule.end += apart;
    }
    return hand;
  }

  PinchScene pinch_;
  Simulation simulation_;
  long frame_ = 0;
  double open_ = 1e9, open_speed_ = 0.0;
};

/// Everything but one fixed block, whose top is z = 0.
inline Simulation fixed_block(ContactModelKind model, const Vector3& size = Vector3(0.2, 0.2, 0.1)) {
  Body block = box_body(size, 1.0);
  block.fixed = true;
  block.start.position.z() = -0.5 * size.z();
  block.material.stiffness = default_material(unfiltered(model)).stiffness;
  return Simulation(scene_of(block), PinchedCube::configuration_of(model, Vector3::Zero()));
}

/// Force of all contacts together [N].
inline Vector3 total_force(const Simulation& simulation) {
  Vector3 sum = Vector3::Zero();
  for (const Contact& contact : simulation.state().contacts) sum += contact.force;
  return sum;
}

}  // namespace mrhi::testing
