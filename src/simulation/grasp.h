#pragma once

#include "../collision/contact_finder.h"
#include "mr_hand_interaction/interaction.h"

namespace mrhi {

/// A hand that hovers over a body does so until it is farther away than this [m].
constexpr double kHoverEnds = 0.045;

/// What the contacts of now, and the distance between them where nothing touches, say of a hand and a body.
/// A grasp is two or more parts of the hand that press the body from sides that largely balance; of bodies
/// that float, joined to each other, all together. What there is `before` lasts longer than it takes to
/// begin: hovering farther away, a grasp less balanced.
InteractionLevel seen_level(const Hand& hand, int slot, int body, const ContactFinder& finder,
                            const Scene& scene, const Pose& body_pose, const std::vector<Contact>& contacts,
                            InteractionLevel before);

}  // namespace mrhi
