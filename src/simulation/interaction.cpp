#include "mr_hand_interaction/interaction.h"

namespace mrhi {
namespace {

/// Times for which a level must be seen before the change is reported [ns].
constexpr Nanoseconds kGraspRiseDelay = 50'000'000, kGraspFallDelay = 60'000'000;
constexpr Nanoseconds kContactFallDelay = 30'000'000;

InteractionLevel next(InteractionLevel level) {
  return static_cast<InteractionLevel>(static_cast<int>(level) + 1);
}
InteractionLevel previous(InteractionLevel level) {
  return static_cast<InteractionLevel>(static_cast<int>(level) - 1);
}

EventKind begin_of(InteractionLevel level) {
  if (level == InteractionLevel::hover) return EventKind::hover_begin;
  return level == InteractionLevel::contact ? EventKind::contact_begin : EventKind::grasp_begin;
}

EventKind end_of(InteractionLevel level) {
  if (level == InteractionLevel::hover) return EventKind::hover_end;
  return level == InteractionLevel::contact ? EventKind::contact_end : EventKind::grasp_end;
}

Nanoseconds rise_delay(InteractionLevel level) {
  return level == InteractionLevel::grasp ? kGraspRiseDelay : 0;
}

Nanoseconds fall_delay(InteractionLevel level) {
  if (level == InteractionLevel::grasp) return kGraspFallDelay;
  return level == InteractionLevel::contact ? kContactFallDelay : 0;
}

void fall(Event event, Interaction& interaction, std::vector<Event>& events) {
  event.kind = end_of(interaction.level);
  events.push_back(event);
  interaction.level = previous(interaction.level);
}

}  // namespace

void update_interaction(InteractionLevel seen, Event event, Interaction& interaction,
                        std::vector<Event>& events) {
  if (seen == interaction.level) {
    interaction.agreed = event.stamp;
    return;
  }
  const Nanoseconds lasted = event.stamp - interaction.agreed;
  while (seen > interaction.level && lasted >= rise_delay(next(interaction.level))) {
    interaction.level = next(interaction.level);
    event.kind = begin_of(interaction.level);
    events.push_back(event);
    if (next(interaction.level) == InteractionLevel::grasp) {
      interaction.agreed = event.stamp;
      break;
    }
  }
  while (seen < interaction.level && lasted >= fall_delay(interaction.level))
    fall(event, interaction, events);
}

void end_interaction(Event event, Interaction& interaction, std::vector<Event>& events) {
  while (interaction.level != InteractionLevel::none) fall(event, interaction, events);
  interaction.agreed = event.stamp;
}

}  // namespace mrhi
