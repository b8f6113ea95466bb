#include "mr_hand_interaction/simulation_state.h"

#include <algorithm>

namespace mrhi {
bool is_held(std::size_t body, const SimulationState& state) {
  for (std::size_t i = body; i < state.interactions.size(); i += state.bodies.size()) {
    if (state.interactions[i].level == InteractionLevel::grasp) return true;
  }
  return false;
}

void forget_contacts(std::size_t body, SimulationState& state) {
  wake_all(state);
  const auto forget = [](auto& contacts, const auto& concerns) {
    contacts.erase(std::remove_if(contacts.begin(), contacts.end(), concerns), contacts.end());
  };
  forget(state.contacts, [body](const Contact& contact) { return contact.key.body == body; });
  forget(state.grips, [body](const Grip& grip) { return grip.body == body; });
  forget(state.body_contacts,
         [body](const BodyContact& contact) { return contact.key.a == body || contact.key.b == body; });
}

void mark_appeared(std::size_t body, SimulationState& state) {
  state.bodies[body].appeared = true;
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot)
    state.interactions[slot * state.bodies.size() + body].shown_in = state.hands[slot].active;
}

void mark_hands_appeared(SimulationState& state) {
  state.contacts.clear();
  state.grips.clear();
  for (HandTrack& track : state.hands) track.appeared = track.active;
}

void place(std::size_t body, const BodyState& placed, SimulationState& state) {
  state.bodies[body] = placed;
  forget_contacts(body, state);
  mark_appeared(body, state);
}

}  // namespace mrhi
