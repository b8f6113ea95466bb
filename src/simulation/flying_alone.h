#pragma once

#include <cstddef>
#include <vector>

#include "../collision/neighbours.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// Bodies that nothing may reach within a frame. Flight is exact at any step, so they fly over the frame at
/// once, in its last step, and stay where it began until then. What is sent towards one of them in between,
/// by a blow, has it fly to where it is by then, and take part in the steps that are left.
class FlyingAlone {
 public:
  explicit FlyingAlone(const Scene& scene)
      : scene_(scene), alone_(scene.bodies.size(), 0), company_(scene.bodies.size(), 0) {}

  /// For a frame of `seconds`, for which Neighbours::begin_step has been called. True if nothing in the scene
  /// may come near a hand or a body that is awake.
  bool begin_frame(const Neighbours& neighbours, double seconds, const SimulationState& state);
  /// Every body takes part in every step.
  void nobody();
  /// Once a step, which is of `step` seconds and begins `passed` seconds into the frame.
  void join(const Neighbours& neighbours, double passed, double step, const Vector3& gravity,
            SimulationState& state);
  bool operator[](std::size_t body) const { return alone_[body] != 0; }

 private:
  const Scene& scene_;
  std::vector<char> alone_, company_;  // by body
  bool any_ = false;
};

}  // namespace mrhi
