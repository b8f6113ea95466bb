#pragma once

#include <cstddef>
#include <vector>

#include "../collision/neighbours.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// Bodies that nothing can reach within a frame. Ballistic flight is exact for any step, so that they fly
/// over the whole frame in its last step, and stay where it began until then. If an impact sends another body
/// towards one of them, it flies to its present place and takes part in the remaining steps.
class IsolatedBodies {
 public:
  explicit IsolatedBodies(const Scene& scene)
      : scene_(scene), isolated_(scene.bodies.size(), 0), may_interact_(scene.bodies.size(), 0) {}

  /// Begins a frame of `seconds`, for which Neighbours::begin_step has been called. True if nothing in the
  /// scene can come near a hand or an awake body.
  bool begin_frame(const Neighbours& neighbours, double seconds, const SimulationState& state);
  /// No body is isolated: all take part in every step.
  void clear();
  /// Call for each step of `step` seconds, which begins `passed` seconds into the frame.
  void join(const Neighbours& neighbours, double passed, double step, const Vector3& gravity,
            SimulationState& state);
  bool operator[](std::size_t body) const { return isolated_[body] != 0; }

 private:
  const Scene& scene_;
  std::vector<char> isolated_, may_interact_;  // by body
  bool any_ = false;
};

}  // namespace mrhi
