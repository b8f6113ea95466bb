#pragma once

#include <cstdint>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// Level of a hand's interaction with an object; each level includes the lower ones.
enum class InteractionLevel : std::uint8_t { none, hover, contact, grasp };

/// A hand's interaction with one body.
struct Interaction {
  InteractionLevel level = InteractionLevel::none;
  Nanoseconds agreed = 0;  ///< when the level last agreed with the contacts
  bool shown_in = false;   ///< the body was spawned in the hand, which is shown in it until it is clear of it
};

/// Numbers are those of InteractionEvent.msg.
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
  int body = -1;  ///< index in Scene::bodies, the one that hangs on it for joint events, -1 for hand events
  std::uint32_t hand_id = 0;  ///< 0 for out_of_bounds and joint events
};

/// Moves `interaction` towards the level `seen`, with one event per level in their fixed order. Grasps begin,
/// and grasps and contacts end, with a short delay, so that one noisy frame makes no event.
void update_interaction(InteractionLevel seen, Event event, Interaction& interaction,
                        std::vector<Event>& events);

/// Ends all levels at once.
void end_interaction(Event event, Interaction& interaction, std::vector<Event>& events);

}  // namespace mrhi
