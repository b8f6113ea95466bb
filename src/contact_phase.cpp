#include "mr_hand_interaction/contact_phase.h"

namespace mrhi {

ContactPhase phase(const Contact& contact) {
  if (!contact.impulse.isZero(0.0)) return ContactPhase::impulse;
  return contact.friction == Friction::sticking ? ContactPhase::sticking : ContactPhase::slipping;
}

std::uint32_t hand_id(const Contact& contact, const SimulationState& state) {
  return state.hands[contact.key.hand].current.id;
}

}  // namespace mrhi
