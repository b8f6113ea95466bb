#include "mr_hand_interaction/scene_change.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "scene/material_fields.h"

namespace mrhi {
namespace {

/// For each body of `before` its index in `after`.
std::vector<std::optional<int>> places_in(const Scene& before, const Scene& after) {
  std::vector<std::optional<int>> places;
  places.reserve(before.bodies.size());
  for (const Body& body : before.bodies) places.push_back(find_body(after, body.name));
  return places;
}

using Places = std::vector<std::optional<int>>;

void move(const Places& places, std::vector<Contact>& contacts) {
  std::vector<Contact> kept;
  kept.reserve(contacts.capacity());
  for (Contact& contact : contacts) {
    const std::optional<int> body = places[contact.key.body];
    if (!body) continue;
    contact.key.body = static_cast<std::uint16_t>(*body);
    kept.push_back(contact);
  }
  contacts.swap(kept);
}

void move(const Places& places, std::vector<BodyContact>& contacts) {
  std::vector<BodyContact> kept;
  kept.reserve(contacts.capacity());
  for (BodyContact& contact : contacts) {
    const std::optional<int> a = places[contact.key.a], b = places[contact.key.b];
    if (!a || !b) continue;
    contact.key.a = static_cast<std::uint16_t>(*a);
    contact.key.b = static_cast<std::uint16_t>(*b);
    kept.push_back(contact);
  }
  contacts.swap(kept);
}

std::vector<Interaction> moved(const Places& places, std::size_t bodies_after, const SimulationState& state) {
  std::vector<Interaction> interactions(state.hands.size() * bodies_after);
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    for (std::size_t b = 0; b < places.size(); ++b) {
      if (!places[b]) continue;
      const auto to = static_cast<std::size_t>(*places[b]);
      interactions[slot * bodies_after + to] = state.interactions[slot * places.size() + b];
    }
  }
  return interactions;
}

bool may_overlap(const Capsule& capsule, const Body& body, const Pose& pose) {
  const double reach = body.bounding_radius + capsule.radius + 0.5 * (capsule.end - capsule.start).norm();
  return capsule.radius > 0.0 && (capsule.centre() - pose.position).norm() <= reach;
}

/// The contact finder keeps the mark on those that do overlap and drops the others.
void ignore_overlaps(std::size_t b, const Body& body, SimulationState& state) {
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    if (!state.hands[slot].active) continue;
    for (std::size_t c = 0; c < kCapsules; ++c) {
      if (!may_overlap(state.hands[slot].current.capsules[c], body, state.bodies[b].pose)) continue;
      for (std::size_t shape = 0; shape < body.shapes.size(); ++shape) {
        Contact contact;
        contact.key = {0, static_cast<std::uint8_t>(shape), static_cast<std::uint8_t>(c),
                       static_cast<std::uint8_t>(slot), static_cast<std::uint16_t>(b)};
        contact.ignored = true;
        state.contacts.push_back(contact);
      }
    }
  }
  std::sort(state.contacts.begin(), state.contacts.end(),
            [](const Contact& x, const Contact& y) { return x.key < y.key; });
}

}  // namespace

SimulationState carried_over(const SimulationState& state, const Scene& before, const Scene& after) {
  const Places places = places_in(before, after);
  SimulationState next = state;
  wake_all(next);
  next.asleep.assign(after.bodies.size(), 0);
  next.bodies.clear();
  for (const Body& body : after.bodies) next.bodies.push_back(start_state(body));
  for (std::size_t b = 0; b < places.size(); ++b) {
    if (places[b]) next.bodies[static_cast<std::size_t>(*places[b])] = state.bodies[b];
  }
  move(places, next.contacts);
  move(places, next.body_contacts);
  next.interactions = moved(places, after.bodies.size(), state);
  for (std::size_t b = 0; b < after.bodies.size(); ++b) {
    if (!find_body(before, after.bodies[b].name)) ignore_overlaps(b, after.bodies[b], next);
  }
  return next;
}

FrameResult carried_over(const FrameResult& result, const Scene& before, const Scene& after) {
  FrameResult next = result;
  move(places_in(before, after), next.contacts);
  next.events.clear();
  return next;
}

void place(std::size_t body, const BodyState& placed, const Scene& scene, SimulationState& state) {
  state.bodies[body] = placed;
  forget_contacts(body, state);
  ignore_overlaps(body, scene.bodies[body], state);
}

std::vector<Event> end_interactions_with(std::size_t body, SimulationState& state) {
  std::vector<Event> events;
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    end_interaction({state.time, EventKind::hover_end, static_cast<int>(body), state.hands[slot].current.id},
                    state.interactions[slot * state.bodies.size() + body], events);
  }
  return events;
}

void set_default_material(const Material& material, Scene& scene) {
  Scene changed = scene;
  for (Body& body : changed.bodies) {
    for (const MaterialField& field : material_fields()) {
      if (!(body.own_material.*field.own)) body.material.*field.value = material.*field.value;
    }
    if (const auto conflict = material_conflict(body.material))
      throw std::invalid_argument("body '" + body.name + "': " + *conflict);
  }
  scene = changed;
}

}  // namespace mrhi
