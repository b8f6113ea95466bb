#include "isolated_bodies.h"

#include <algorithm>

#include "../integration/free_flight.h"

namespace mrhi {

bool IsolatedBodies::begin_frame(const Neighbours& neighbours, double seconds, const SimulationState& state) {
  may_interact_.assign(scene_.bodies.size(), 0);
  bool quiet = true;
  const auto meets = [&](std::size_t body) {
    may_interact_[body] = 1;
    quiet = false;
  };
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    for (const NearBody& near : neighbours.near_hand(static_cast<int>(slot))) {
      if (neighbours.may_meet_hand(near.body, state.bodies[near.body], seconds)) meets(near.body);
    }
  }
  for (const auto& [a, b] : neighbours.pairs()) {
    const bool asleep = state.asleep[b] && (state.asleep[a] || scene_.bodies[a].fixed);
    if (!asleep && neighbours.may_meet(a, b, state.bodies, seconds)) meets(a), meets(b);
  }
  for (const Grip& grip : state.grips) may_interact_[grip.body] = 1;
  any_ = false;
  for (std::size_t b = 0; b < isolated_.size(); ++b) {
    isolated_[b] = scene_.bodies[b].flies && !may_interact_[b] && !state.asleep[b];
    any_ = any_ || isolated_[b];
  }
  return quiet;
}

void IsolatedBodies::clear() {
  if (any_) std::fill(isolated_.begin(), isolated_.end(), char(0));
  any_ = false;
}

void IsolatedBodies::join(const Neighbours& neighbours, double passed, double step, const Vector3& gravity,
                          SimulationState& state) {
  if (!any_) return;
  for (const auto& [a, b] : neighbours.pairs()) {
    if (isolated_[a] == isolated_[b]) continue;  // two isolated bodies cannot meet in the frame
    // The isolated body is still where the frame began.
    if (!neighbours.may_meet(a, b, state.bodies, passed + step)) continue;
    const int joins = isolated_[a] ? a : b;
    free_flight(scene_.bodies[joins], gravity, passed, state.bodies[joins]);
    isolated_[joins] = 0;
  }
}

}  // namespace mrhi
