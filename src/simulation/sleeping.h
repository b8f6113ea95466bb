#pragma once

#include <vector>

#include "../collision/neighbours.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// Sleep of bodies at rest on others, or on joints that hold: they cost nothing until a hand or a moving body
/// may come near. A body that nothing holds never sleeps, however slowly it drifts. A linkage sleeps as a
/// whole.
class Sleeping {
 public:
  /// Keeps a reference.
  Sleeping(const Scene& scene, bool allowed) : scene_(scene), allowed_(allowed) {}

  /// Wakes bodies that something may come near within `step` seconds. Call before contacts are found.
  void wake(const Neighbours& neighbours, double step, SimulationState& state) const;
  /// Puts bodies to sleep that have been still for long enough. Call after the response.
  void settle(const Neighbours& neighbours, double step, SimulationState& state);

 private:
  bool still(int body, const SimulationState& state) const;
  bool count_rest(double step, SimulationState& state) const;
  void find_tired(const Neighbours& neighbours, double step, const SimulationState& state);
  void follow_joints(const SimulationState& state);
  bool clear_connected(const Neighbours& neighbours, double step, const std::vector<BodyState>& bodies,
                       const std::vector<char>* ignored, std::vector<char>& flags) const;
  /// True for the world and for fixtures.
  bool is_ground(int body) const { return body == Joint::kWorld || scene_.bodies[body].fixed; }

  const Scene& scene_;
  bool allowed_;
  std::vector<char> tired_;  // by body
};

}  // namespace mrhi
