#pragma once

#include "mr_hand_interaction/simulation_state.h"
#include "skin.h"

namespace mrhi {

/// Flattens the pads of a hand's skin against what they press: skin that is nearer to the touched plane than
/// the pad's compression lies on it, and skin up to three times as far comes nearer. The compression grows
/// with the force as a fingertip's does, to kDeepestPress.
void press_flat(const std::vector<Contact>& contacts, const SimulationState& state, std::uint32_t hand,
                const Skin& skin, SkinSurface& surface);

constexpr double kDeepestPress = 0.0018;  ///< [m]

}  // namespace mrhi
