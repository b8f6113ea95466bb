#include "frame_report.h"

#include <algorithm>
#include <memory>

#include "../collision/neighbours.h"
#include "../rendering/mass_lag.h"
#include "../response/finger_limits.h"
#include "grasp.h"

namespace mrhi {
namespace {

void find_contacts(const FrameEnd& end, std::vector<Contact>& contacts) {
  for (HandMotion& hand : end.hands) hand.move_to(1.0, 1.0);
  contacts.reserve(end.state.contacts.capacity());  // the finder keeps what it is given, for the next step
  contacts = end.state.contacts;
  end.neighbours.begin_step(end.state.bodies, 0.0);
  end.finder.find(end.hands, end.neighbours, end.state.bodies, 0.0, contacts);
  for (Contact& contact : contacts) contact.impulse.setZero(), contact.force.setZero();
  contacts.erase(
      std::remove_if(contacts.begin(), contacts.end(), [](const Contact& c) { return !c.touching(); }),
      contacts.end());
  share_strength(end.strength, contacts);
}

bool before(const Contact& contact, const ContactKey& key) {
  return contact.key < key;
}

/// The mean force is the transferred momentum over the frame's time. A contact that has ended is reported at
/// its last place, without depth.
void add_transfer(const FrameTransfer& transfer, std::vector<Contact>& contacts) {
  const std::size_t touching = contacts.size();
  const double rate = transfer.seconds > 0.0 ? 1.0 / transfer.seconds : 0.0;
  for (const Contact& moved : transfer.contacts) {
    const auto end = contacts.begin() + static_cast<std::ptrdiff_t>(touching);
    auto same = std::lower_bound(contacts.begin(), end, moved.key, before);
    if (same == end || !(same->key == moved.key)) {
      contacts.push_back(moved);
      same = contacts.end() - 1;
      same->depth = std::min(same->depth, 0.0);
    }
    same->impulse = moved.impulse;
    same->force = rate * moved.force;
  }
  if (contacts.size() > touching) {
    std::sort(contacts.begin(), contacts.end(),
              [](const Contact& a, const Contact& b) { return a.key < b.key; });
  }
}

/// The hand's active or released grip on the object that the body belongs to: the body or its linkage.
const Grip* grip_on(const FrameEnd& end, std::size_t slot, int body) {
  const auto object = [&](int part) { return floating_root(end.scene, part).value_or(part); };
  for (const Grip& grip : end.state.grips)
    if (grip.hand == slot && (grip.active || grip.released) && object(grip.body) == object(body))
      return &grip;
  return nullptr;
}

void update_interactions(const FrameEnd& end, FrameResult& result) {
  SimulationState& state = end.state;
  const std::size_t bodies = end.scene.bodies.size();
  const bool struck = std::any_of(end.transfer.contacts.begin(), end.transfer.contacts.end(),
                                  [](const Contact& contact) { return !contact.impulse.isZero(0.0); });
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    if (!state.hands[slot].active) continue;
    const HandTrack& track = end.operators.in_world(slot, state);
    const Eigen::AlignedBox3d hand = box_around(track.current);
    for (std::size_t b = 0; b < bodies; ++b) {
      const int body = static_cast<int>(b);
      const bool near =
          is_near(hand, state.bodies[b].pose.position, end.scene.bodies[b].bounding_radius + kHoverEnds);
      Interaction& interaction = state.interactions[slot * bodies + b];
      const bool may_end = interaction.level != InteractionLevel::none || struck;
      const bool is_held_fixture = end.scene.bodies[b].fixed && !end.operators.none();
      if ((end.scene.bodies[b].fixed && !is_held_fixture) || end.scene.bodies[b].is_operator ||
          (!near && !may_end))
        continue;
      const Grip* const grip = grip_on(end, slot, body);
      InteractionLevel seen = InteractionLevel::contact;
      if (grip == nullptr || (grip->active && grip->body != b))
        seen = seen_level(track.current, static_cast<int>(slot), body, end.finder, end.scene,
                          state.bodies[b].pose, result.contacts, interaction.level);
      // A supported object is grasped; of a linkage, the links that the hand touches.
      if (grip != nullptr && grip->active && seen == InteractionLevel::contact)
        seen = InteractionLevel::grasp;
      if (grasp_of(end.scene, body) == GraspMode::never) seen = std::min(seen, InteractionLevel::contact);
      update_interaction(seen, {state.time, EventKind::hover_begin, body, track.current.id}, interaction,
                         result.events);
    }
  }
}

}  // namespace

void report_frame(const FrameEnd& end, FrameResult& result) {
  find_contacts(end, result.contacts);
  add_transfer(end.transfer, result.contacts);
  for (GraspSupport assist : end.transfer.assists) {
    assist.force /= end.transfer.seconds;
    result.assists.push_back(assist);
  }
  update_interactions(end, result);
  for (std::size_t slot = 0; slot < end.state.hands.size(); ++slot)
    if (end.state.hands[slot].active)
      result.tracked.push_back(end.operators.in_world(slot, end.state).current);
}

namespace {

/// The track of the slot displaced by its mass lag, stored in `lagging`; the track itself without lag.
const HandTrack& lagging_track(std::size_t slot, const Rendering& rendering, const FrameResult& result,
                               std::unique_ptr<HandTrack>& lagging) {
  MassLag& lag = rendering.state.mass_lags[slot];
  const HandTrack& track = rendering.operators.in_world(slot, rendering.state);
  if (track.appeared || rendering.control_display_ratio <= 1.0) lag = MassLag();
  if (rendering.control_display_ratio <= 1.0) return track;
  const MassLag before = lag;
  const Nanoseconds now = rendering.state.time;
  MovedMass moved;
  if (before.stamp != 0 && now > before.stamp)
    moved = moved_mass(static_cast<int>(slot), to_seconds(now - before.stamp), rendering.scene,
                       rendering.gravity, result);
  advance_mass_lag(rendering.control_display_ratio, moved, now, lag);
  if (before.zero() && lag.zero()) return track;
  if (!lagging) lagging = std::make_unique<HandTrack>();
  lag_behind(before, lag, track, *lagging);
  return *lagging;
}

}  // namespace

void render_hands(const Rendering& rendering, FrameResult& result) {
  SimulationState& state = rendering.state;
  std::unique_ptr<HandTrack> lagging;  // large: made only when a hand lags
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    if (!state.hands[slot].active) continue;
    const HandTrack& track = lagging_track(slot, rendering, result, lagging);
    result.rendered.emplace_back();
    HandFrameView view{track,           static_cast<int>(slot),
                       state.time,      state.bodies,
                       result.contacts, state.interactions.data() + slot * state.bodies.size()};
    rendering.renderer.render(view, state.offsets[slot], result.rendered.back());
  }
}

void FrameTransfer::add(const SimulationState& after, double step) {
  seconds += step;
  for (const Grip& grip : after.grips) {
    if (!grip.active) continue;
    const auto same = std::find_if(assists.begin(), assists.end(), [&](const GraspSupport& known) {
      return known.hand == grip.hand && known.body == grip.body;
    });
    if (same == assists.end()) {
      assists.push_back({grip.hand, grip.body, step * grip.force});
    } else {
      same->force += step * grip.force;
    }
  }
  for (const Contact& contact : after.contacts) {
    if (contact.impulse.isZero(0.0) && contact.force.isZero(0.0)) continue;
    auto known = std::lower_bound(contacts.begin(), contacts.end(), contact.key, before);
    if (known == contacts.end() || !(known->key == contact.key)) {
      known = contacts.insert(known, contact);
      known->force *= step;
    } else {
      known->impulse += contact.impulse;
      known->force += step * contact.force;
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
