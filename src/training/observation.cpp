#include "mr_hand_interaction/training/observation.h"

#include <algorithm>

namespace mrhi {

Observation observe(const Simulation& simulation, std::size_t body) {
  const FrameResult& result = simulation.result();
  const BodyState& state = simulation.state().bodies[body];
  Observation seen;
  seen.stamp = result.stamp;
  seen.pose = state.pose;
  seen.twist = twist_of(simulation.scene().bodies[body], state);
  seen.held = is_held(body, simulation.state());
  double pressing = 0.0;
  for (const Contact& contact : result.contacts) {
    if (contact.key.body != body) continue;
    seen.touched = true;
    pressing += std::max(0.0, -contact.normal.dot(contact.force));
  }
  seen.grip_force = 0.5 * pressing;
  for (const Event& event : result.events) {
    seen.tracking_losses += event.kind == EventKind::hand_lost;
    seen.put_back |= event.kind == EventKind::out_of_bounds && event.body == static_cast<int>(body);
  }
  return seen;
}

}  // namespace mrhi
