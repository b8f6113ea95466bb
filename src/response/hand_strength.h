#pragma once

#include "mr_hand_interaction/configuration.h"
#include "mr_hand_interaction/response/contact_model.h"

namespace mrhi {

/// Tells every contact what the hand has for it: a finger's strength is shared by all its points that press,
/// on whatever bodies, by their depths; the mass of a blow is that of the phalanx.
void share_strength(const HandStrength& hand, std::vector<Contact>& contacts);

}  // namespace mrhi
