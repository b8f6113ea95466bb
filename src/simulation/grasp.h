#pragma once

#include "../collision/contact_finder.h"
#include "mr_hand_interaction/interaction.h"

namespace mrhi {

/// Distance at which hovering over a body ends [m].
constexpr double kHoverEnds = 0.045;

/// Interaction level of a hand and a body from their present contacts, or from their distance without
/// contacts. A grasp needs two or more parts of the hand whose loads on the body largely balance; a floating
/// linkage counts as one body. With hysteresis: a level of `before` may last with a larger distance or less
/// balance.
InteractionLevel seen_level(const Hand& hand, int slot, int body, const ContactFinder& finder,
                            const Scene& scene, const Pose& body_pose, const std::vector<Contact>& contacts,
                            InteractionLevel before);

}  // namespace mrhi
