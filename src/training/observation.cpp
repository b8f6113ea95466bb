#include "mr_hand_interaction/training/observation.h"

#include <algorithm>

#include "../scene/scene_edit.h"

namespace mrhi {

Observation observe(const Simulation& simulation, std::size_t body) {
  const FrameResult& result = simulation.result();
  const BodyState& state = simulation.state().bodies[body];
  Observation seen;
  seen.stamp = result.stamp;
  seen.pose = state.pose;
  seen.twist = twist_of(simulation.scene().bodies[body], state);
  const std::vector<std::size_t> parts = hanging_on(body, simulation.scene());
  const auto is_part = [&](int b) {
    return std::find(parts.begin(), parts.end(), static_cast<std::size_t>(b)) != parts.end();
  };
  seen.held = std::any_of(parts.begin(), parts.end(),
                          [&](std::size_t part) { return is_held(part, simulation.state()); });
  double pressing = 0.0;
  for (const Contact& contact : result.contacts) {
    if (!is_part(contact.key.body)) continue;
    seen.touched = true;
    pressing += std::max(0.0, -contact.normal.dot(contact.force));
  }
  seen.grip_force = 0.5 * pressing;
  for (const Event& event : result.events) {
    seen.tracking_losses += event.kind == EventKind::hand_lost;
    seen.put_back |= event.kind == EventKind::out_of_bounds && is_part(event.body);
  }
  const std::vector<Joint>& joints = simulation.scene().joints;
  for (std::size_t j = 0; j < joints.size(); ++j) {
    if (is_part(joints[j].child))
      seen.joints.emplace_back(joints[j].name, simulation.state().joints[j].position);
  }
  return seen;
}

}  // namespace mrhi
