#pragma once

#include "mr_hand_interaction/simulation_state.h"

namespace mrhi {

/// What a contact does, as recordings and messages number it.
enum class ContactPhase : std::uint8_t { impulse = 0, sticking = 1, slipping = 2 };
ContactPhase phase(const Contact& contact);

/// The tracker's id of the contact's hand.
std::uint32_t hand_id(const Contact& contact, const SimulationState& state);

}  // namespace mrhi
