#include "frame_report.h"

#include <algorithm>

#include "grasp.h"
#include "mr_hand_interaction/collision/near_bodies.h"
#include "mr_hand_interaction/rendering/rendered_hand.h"

namespace mrhi {
namespace {

/// The hand where it is at the frame's end.
HandMotion resting_hand(const HandTrack& track, int slot) {
  HandTrack resting = track;
  resting.previous = resting.current;
  HandMotion motion(resting, slot, 0.0);
  motion.move_to(1.0);
  return motion;
}

std::vector<Contact> contacts_at_end(const FrameEnd& end) {
  std::vector<HandMotion> hands;
  for (int slot = 0; slot < kMaxHands; ++slot) {
    const HandTrack& track = end.state.hands[static_cast<std::size_t>(slot)];
    if (track.active && !track.appeared) hands.push_back(resting_hand(track, slot));
  }
  std::vector<Contact> contacts;
  contacts.reserve(end.state.contacts.capacity());  // the finder keeps what it is given, for the next step
  contacts = end.state.contacts;
  end.neighbours.begin_step(end.state.bodies, 0.0);
  end.finder.find(hands, end.neighbours, end.state.bodies, 0.0, contacts);
  for (Contact& contact : contacts) contact.impulse.setZero();
  contacts.erase(
      std::remove_if(contacts.begin(), contacts.end(), [](const Contact& c) { return !c.touching(); }),
      contacts.end());
  return contacts;
}

std::vector<Contact>::iterator same_contact(std::vector<Contact>& contacts, const Contact& wanted) {
  return std::find_if(contacts.begin(), contacts.end(),
                      [&wanted](const Contact& contact) { return contact.key == wanted.key; });
}

void add_strikes(const std::vector<Contact>& strikes, std::vector<Contact>& contacts) {
  for (const Contact& strike : strikes) {
    const auto same = same_contact(contacts, strike);
    if (same == contacts.end()) {
      contacts.push_back(strike);
    } else {
      same->impulse = strike.impulse;
    }
  }
  std::sort(contacts.begin(), contacts.end(),
            [](const Contact& a, const Contact& b) { return a.key < b.key; });
}

void update_interactions(const FrameEnd& end, FrameResult& result) {
  SimulationState& state = end.state;
  const std::size_t bodies = end.scene.bodies.size();
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    const HandTrack& track = state.hands[slot];
    if (!track.active) continue;
    const std::vector<int> near = near_bodies(track.current, end.scene, state.bodies, kHoverEnds);
    auto next = near.begin();
    for (std::size_t b = 0; b < bodies; ++b) {
      const int body = static_cast<int>(b);
      const bool is_near = next != near.end() && *next == body;
      if (is_near) ++next;
      Interaction& interaction = state.interactions[slot * bodies + b];
      const bool may_end = interaction.level != InteractionLevel::none || !end.strikes.empty();
      if (end.scene.bodies[b].fixed || (!is_near && !may_end)) continue;
      const InteractionLevel seen =
          seen_level(track.current, static_cast<int>(slot), body, end.finder, end.scene, state.bodies[b].pose,
                     result.contacts, interaction.level);
      update_interaction(seen, {state.time, EventKind::hover_begin, body, track.current.id}, interaction,
                         result.events);
    }
  }
}

void render(const FrameEnd& end, FrameResult& result) {
  for (std::size_t slot = 0; slot < end.state.hands.size(); ++slot) {
    const HandTrack& track = end.state.hands[slot];
    if (!track.active) continue;
    result.tracked.push_back(track.current);
    result.rendered.push_back(render_hand(track.current, static_cast<int>(slot), end.finder, end.scene,
                                          end.state.bodies, result.contacts));
    result.deepest_rendered =
        std::max(result.deepest_rendered,
                 deepest_penetration(result.rendered.back().hand, end.finder, end.scene, end.state.bodies));
  }
}

}  // namespace

void report_frame(const FrameEnd& end, FrameResult& result) {
  result.contacts = contacts_at_end(end);
  add_strikes(end.strikes, result.contacts);
  update_interactions(end, result);
  render(end, result);
}

void note_strikes(const std::vector<Contact>& contacts, std::vector<Contact>& strikes) {
  for (const Contact& contact : contacts) {
    if (contact.impulse == Vector3::Zero()) continue;
    const auto known = same_contact(strikes, contact);
    if (known == strikes.end()) {
      strikes.push_back(contact);
    } else {
      known->impulse += contact.impulse;
    }
  }
}

void end_interactions(std::size_t slot, Nanoseconds now, SimulationState& state, std::vector<Event>& events) {
  const std::size_t bodies = state.bodies.size();
  for (std::size_t b = 0; b < bodies; ++b) {
    end_interaction({now, EventKind::hover_end, static_cast<int>(b), state.hands[slot].current.id},
                    state.interactions[slot * bodies + b], events);
  }
}

}  // namespace mrhi
