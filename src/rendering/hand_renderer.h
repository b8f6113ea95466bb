#pragma once

#include <memory>
#include <vector>

#include "../collision/contact_finder.h"
#include "mr_hand_interaction/interaction.h"
#include "mr_hand_interaction/rendering/rendered_hand.h"
#include "mr_hand_interaction/tracking/hand_track.h"

namespace mrhi {

/// Shows a tracked hand outside all bodies as one connected hand: its bones as tracked, turned about its
/// joints within their limits, and where that is not enough shifted as a whole. docs/pipeline.md.
class HandRenderer {
 public:
  /// Keeps references.
  HandRenderer(const Scene& scene, const ContactFinder& finder);
  ~HandRenderer();

  /// Renders the hand of a track at its frame's `stamp`. `contacts` are the present ones, with the faces that
  /// phalanges entered by. `offset` is the hand's of the previous frame, and is updated. `interactions` are
  /// the hand's, one per body: `shown_in` marks bodies in which the hand may be shown, and is cleared here.
  void render(const HandTrack& track, int slot, Nanoseconds stamp, const std::vector<BodyState>& bodies,
              const std::vector<Contact>& contacts, Interaction* interactions, HandOffset& offset,
              RenderedHand& rendered);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Sets which capsules touch, and with what force, from the contacts of the hand in `slot`.
void note_touches(const std::vector<Contact>& contacts, int slot, RenderedHand& rendered);

/// Deepest penetration of any of the hand's capsules into any body, but for those that it is shown in
/// (`interactions`, as in render) [m], >= 0. Looks at the hand as it is: it shares nothing with what made it.
double deepest_penetration(const Hand& hand, const ContactFinder& finder, const Scene& scene,
                           const std::vector<BodyState>& bodies, const Interaction* interactions);

}  // namespace mrhi
