#pragma once

#include <cstdint>
#include <vector>

#include "mr_hand_interaction/math.h"

namespace mrhi {

/// How far a hand has got with an object; each level includes those before it.
enum class InteractionLevel : std::uint8_t { none, hover, contact, grasp };

/// A hand's interaction with one body.
struct Interaction {
  InteractionLevel level = InteractionLevel::none;
  Nanoseconds agreed = 0;  ///< when the level last was what the contacts say
  bool shown_in = false;   ///< the body appeared: the hand is shown in it until it is once clear of it
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
  joint_limit,  ///< a joint has come to one of its limits
  detent,       ///< has snapped into another detent
  latch_open    ///< has been pulled out of its latch
};

struct Event {
  Nanoseconds stamp = 0;
  EventKind kind = EventKind::hover_begin;
  int body = -1;  ///< index in Scene::bodies, the one that hangs on it for joint events, -1 for hand events
  std::uint32_t hand_id = 0;  ///< 0 for out_of_bounds and joint events
};

/// Moves `interaction` towards the level that the contacts say now, one event per level in their fixed order.
/// A grasp begins once it has lasted a little and ends once it has been gone a little, a contact likewise, so
/// that one noisy frame makes no event.
void update_interaction(InteractionLevel seen, Event event, Interaction& interaction,
                        std::vector<Event>& events);

/// Ends all levels at once.
void end_interaction(Event event, Interaction& interaction, std::vector<Event>& events);

}  // namespace mrhi
