#include "flying_alone.h"

#include <algorithm>

#include "../integration/free_flight.h"

namespace mrhi {

bool FlyingAlone::begin_frame(const Neighbours& neighbours, double seconds, const SimulationState& state) {
  company_.assign(scene_.bodies.size(), 0);
  bool quiet = true;
  const auto meets = [&](std::size_t body) {
    company_[body] = 1;
    quiet = false;
  };
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    for (const NearBody& near : neighbours.near_hand(static_cast<int>(slot))) {
      const auto b = static_cast<std::size_t>(near.body);
      if (neighbours.may_meet_hand(b, state.bodies[b], seconds)) meets(b);
    }
  }
  for (const auto& [first, second] : neighbours.pairs()) {
    const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
    const bool asleep = state.asleep[b] && (state.asleep[a] || scene_.bodies[a].fixed);
    if (!asleep && neighbours.may_meet(a, b, state.bodies, seconds)) meets(a), meets(b);
  }
  for (const Grip& grip : state.grips) company_[grip.body] = 1;
  any_ = false;
  for (std::size_t b = 0; b < alone_.size(); ++b) {
    alone_[b] = scene_.bodies[b].flies && !company_[b] && !state.asleep[b];
    any_ = any_ || alone_[b];
  }
  return quiet;
}

void FlyingAlone::nobody() {
  if (any_) std::fill(alone_.begin(), alone_.end(), char(0));
  any_ = false;
}

void FlyingAlone::join(const Neighbours& neighbours, double passed, double step, const Vector3& gravity,
                       SimulationState& state) {
  if (!any_) return;
  for (const auto& [first, second] : neighbours.pairs()) {
    const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
    if (alone_[a] == alone_[b]) continue;  // both: what may meet within the frame is not alone
    // From where the frame began, one of them has all the time since then to get there.
    if (!neighbours.may_meet(a, b, state.bodies, passed + step)) continue;
    const std::size_t joins = alone_[a] ? a : b;
    free_flight(scene_.bodies[joins], gravity, passed, state.bodies[joins]);
    alone_[joins] = 0;
  }
}

}  // namespace mrhi
