#include "mr_hand_interaction/interaction.h"

namespace mrhi {
namespace {

/// Times for which a level must be seen before the change is reported [ns].
constexpr Nanoseconds kGraspRiseDelay = 50'000'000, kGraspFallDelay = 60'000'000;
constexpr Nanoseconds kContactFallDelay = 30'000'000;

/// How a level begins and ends, in the order of InteractionLevel.
struct LevelChange {
  EventKind begin, end;
  Nanoseconds rise_delay, fall_delay;
};
constexpr LevelChange kChanges[] = {
    {},
    {EventKind::hover_begin, EventKind::hover_end, 0, 0},
    {EventKind::contact_begin, EventKind::contact_end, 0, kContactFallDelay},
    {EventKind::grasp_begin, EventKind::grasp_end, kGraspRiseDelay, kGraspFallDelay}};

const LevelChange& change_of(InteractionLevel level) {
  return kChanges[static_cast<std::size_t>(level)];
}
InteractionLevel next(InteractionLevel level) {
  return static_cast<InteractionLevel>(static_cast<int>(level) + 1);
}

void fall(Event event, Interaction& interaction, std::vector<Event>& events) {
  event.kind = change_of(interaction.level).end;
  events.push_back(event);
  interaction.level = static_cast<InteractionLevel>(static_cast<int>(interaction.level) - 1);
}

}  // namespace

void update_interaction(InteractionLevel seen, Event event, Interaction& interaction,
                        std::vector<Event>& events) {
  if (seen == interaction.level) {
    interaction.agreed = event.stamp;
    return;
  }
  const Nanoseconds lasted = event.stamp - interaction.agreed;
  while (seen > interaction.level && lasted >= change_of(next(interaction.level)).rise_delay) {
    interaction.level = next(interaction.level);
    event.kind = change_of(interaction.level).begin;
    events.push_back(event);
    if (next(interaction.level) == InteractionLevel::grasp) {
      interaction.agreed = event.stamp;
      break;
    }
  }
  while (seen < interaction.level && lasted >= change_of(interaction.level).fall_delay)
    fall(event, interaction, events);
}

void end_interaction(Event event, Interaction& interaction, std::vector<Event>& events) {
  while (interaction.level != InteractionLevel::none) fall(event, interaction, events);
  interaction.agreed = event.stamp;
}

}  // namespace mrhi
