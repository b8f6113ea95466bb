#pragma once

#include <vector>

#include "../collision/neighbours.h"
#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// Bodies that lie still on others sleep: they cost nothing until a hand, or a body that moves, may come
/// near. What touches nothing never sleeps, however slowly it drifts.
class Sleeping {
 public:
  /// Keeps a reference.
  Sleeping(const Scene& scene, bool allowed) : scene_(scene), allowed_(allowed) {}

  /// Before contacts are sought: wakes those that something may come near to within `step` seconds.
  void wake(const Neighbours& neighbours, double step, SimulationState& state) const;
  /// After the response: sends to sleep those that have been still for long enough.
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
