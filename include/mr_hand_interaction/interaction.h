#pragma once

#include <cstdint>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Level of a hand's interaction with an object; each includes those before it.
enum class InteractionLevel : std::uint8_t { none, hover, contact, grasp };

/// A hand's interaction with one body.
struct Interaction {
  InteractionLevel level = InteractionLevel::none;
  Nanoseconds agreed = 0;  ///< last time at which the contacts confirmed the level
  bool shown_in = false;   ///< spawned in the hand: rendering ignores the body until they separate
};

/// Numbers as in InteractionEvent.msg.
enum class EventKind : std::uint8_t {
  hover_begin,
  hover_end,
  contact_begin,
  contact_end,
  grasp_begin,
  grasp_end,
  hand_lost,
  hand_found,
  out_of_bounds,
  joint_limit,  ///< a joint has reached one of its limits
  detent,       ///< a joint has snapped into another detent
  latch_open    ///< a joint has been pulled out of its latch
};

struct Event {
  Nanoseconds stamp = 0;
  EventKind kind = EventKind::hover_begin;
  int body = -1;  ///< index in Scene::bodies; for joint events the joint's child; -1 for hand events
  std::uint32_t hand_id = 0;  ///< 0 for out_of_bounds and joint events
};

/// Moves `interaction` towards the level that the contacts show now, with one event for each level in their
/// fixed order. Grasps and contacts begin and end after a short delay, so that one noisy frame causes no
/// event.
void update_interaction(InteractionLevel seen, Event event, Interaction& interaction,
                        std::vector<Event>& events);

/// Ends all levels at once.
void end_interaction(Event event, Interaction& interaction, std::vector<Event>& events);

}  // namespace mrhi
