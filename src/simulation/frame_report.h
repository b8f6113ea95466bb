#pragma once

#include <vector>

#include "../collision/contact_finder.h"
#include "../rendering/hand_renderer.h"
#include "mr_hand_interaction/simulation.h"

namespace mrhi {

/// What a frame's result is made from, once bodies and hands are at the frame's stamp.
struct FrameEnd {
  const Scene& scene;
  std::vector<HandMotion>& hands;  ///< those that can touch
  Neighbours& neighbours;
  ContactFinder& finder;
  const std::vector<Contact>& strikes;  ///< impacts since the frame before, one entry per contact
  SimulationState& state;               ///< its interactions are updated
};

/// Contacts as they are at the frame's end, with the last step's forces, and the impacts since the frame
/// before; then the events that follow from them, and the tracked hands.
void report_frame(const FrameEnd& end, FrameResult& result);

/// The hands as they are shown, from the contacts of the report; their offsets in the state are updated.
void render_hands(HandRenderer& renderer, SimulationState& state, FrameResult& result);

/// Adds a step's impacts to those of the frame.
void note_strikes(const std::vector<Contact>& contacts, std::vector<Contact>& strikes);

/// Ends what a hand does with every body, before the hand is lost.
void end_interactions(std::size_t slot, Nanoseconds now, SimulationState& state, std::vector<Event>& events);

}  // namespace mrhi
