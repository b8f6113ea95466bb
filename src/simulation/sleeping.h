#pragma once

#include <vector>

#include "../collision/neighbours.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// Sleep of bodies at rest on others: they cost nothing until a hand or a moving body may come near. A body
/// without contacts never sleeps, however slowly it drifts.
class Sleeping {
 public:
  /// Keeps a reference.
  Sleeping(const Scene& scene, bool allowed) : scene_(scene), allowed_(allowed) {}

  /// Wakes bodies that something may come near within `step` seconds. Call before contacts are found.
  void wake(const Neighbours& neighbours, double step, SimulationState& state) const;
  /// Puts bodies to sleep that have been still for long enough. Call after the response.
  void settle(const Neighbours& neighbours, double step, SimulationState& state);

 private:
  bool still(std::size_t body, const BodyState& state) const;
  bool count_rest(double step, SimulationState& state) const;
  void find_tired(const Neighbours& neighbours, double step, const SimulationState& state);

  const Scene& scene_;
  bool allowed_;
  std::vector<char> tired_;  // by body
};

}  // namespace mrhi
