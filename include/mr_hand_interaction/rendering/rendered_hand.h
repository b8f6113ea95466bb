#pragma once

#include <array>
#include <vector>

#include "mr_hand_interaction/collision/contact_finder.h"
#include "mr_hand_interaction/tracking/hand.h"

namespace mrhi {

/// One hand as shown: outside every object.
struct RenderedHand {
  Hand hand;
  std::array<bool, kCapsules> touching{};
};

/// Pushes a tracked hand's joints out of all bodies while its bones keep together (position-based
/// constraints, Mueller et al. 2007): the rendered hand is where the god objects are, the tracked hand where
/// it is free. `contacts` are this hand's, with the faces that its phalanges entered by.
RenderedHand render_hand(const Hand& tracked, int slot, const ContactFinder& finder, const Scene& scene,
                         const std::vector<BodyState>& bodies, const std::vector<Contact>& contacts);

/// Deepest penetration of any of the hand's capsules into any body [m], >= 0.
double deepest_penetration(const Hand& hand, const ContactFinder& finder, const Scene& scene,
                           const std::vector<BodyState>& bodies);

}  // namespace mrhi
