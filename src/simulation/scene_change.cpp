#include "scene_change.h"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <unordered_map>

#include "../joints/joint_law.h"
#include "../scene/limits.h"

namespace mrhi {
namespace {

using Places = std::vector<std::optional<int>>;

/// For each body of `before` its index in `after`.
Places places_in(const Scene& before, const Scene& after) {
  std::unordered_map<std::string_view, int> by_name;
  for (std::size_t b = 0; b < after.bodies.size(); ++b)
    by_name.emplace(after.bodies[b].name, static_cast<int>(b));
  Places places;
  places.reserve(before.bodies.size());
  for (const Body& body : before.bodies) {
    const auto found = by_name.find(body.name);
    places.push_back(found == by_name.end() ? std::nullopt : std::make_optional(found->second));
  }
  return places;
}

/// Renumbers the body; false if it is no longer there.
bool renumber(const Places& places, std::uint16_t& body) {
  const std::optional<int> place = places[body];
  if (place) body = static_cast<std::uint16_t>(*place);
  return place.has_value();
}

bool renumber(const Places& places, Contact& contact) {
  return renumber(places, contact.key.body);
}

bool renumber(const Places& places, BodyContact& contact) {
  return renumber(places, contact.key.a) && renumber(places, contact.key.b);
}

bool renumber(const Places& places, Grip& grip) {
  return renumber(places, grip.body);
}

/// Renumbers the bodies of all items, and drops those of bodies that are no longer there.
template <typename Item>
void move(const Places& places, std::vector<Item>& items) {
  const auto is_gone = [&](Item& item) { return !renumber(places, item); };
  items.erase(std::remove_if(items.begin(), items.end(), is_gone), items.end());
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

/// Copies the states of joints that both scenes have by name.
void carry_joints(const SimulationState& state, const Scene& before, const Scene& after,
                  SimulationState& next) {
  next.joints.clear();
  for (const Joint& joint : after.joints) {
    const std::optional<int> was = find_joint(before, joint.name);
    next.joints.push_back(was ? state.joints[*was] : start_state(joint));
  }
}

/// Copies the restraints of operators that both scenes have by name.
void carry_restraints(const SimulationState& state, const Scene& before, const Scene& after,
                      SimulationState& next) {
  next.restrained.assign(after.operators.size(), 0);
  for (std::size_t o = 0; o < after.operators.size(); ++o) {
    const auto name = [](const Scene& scene, const Operator& op) -> const std::string& {
      return scene.bodies[op.body].name;
    };
    for (std::size_t was = 0; was < before.operators.size() && after.operators[o].restraint; ++was) {
      if (name(before, before.operators[was]) == name(after, after.operators[o]))
        next.restrained[o] = state.restrained[was];
    }
  }
}

}  // namespace

SimulationState carried_over(const SimulationState& state, const Scene& before, const Scene& after) {
  const Places places = places_in(before, after);
  SimulationState next = state;
  wake_all(next);
  next.asleep.assign(after.bodies.size(), 0);
  next.bodies.clear();
  for (const Body& body : after.bodies) next.bodies.push_back(start_state(body));
  std::vector<char> was_there(after.bodies.size(), 0);
  for (std::size_t b = 0; b < places.size(); ++b) {
    if (!places[b]) continue;
    next.bodies[*places[b]] = state.bodies[b];
    was_there[*places[b]] = 1;
  }
  carry_joints(state, before, after, next);
  carry_restraints(state, before, after, next);
  move(places, next.contacts);
  move(places, next.body_contacts);
  move(places, next.grips);
  next.interactions = moved(places, after.bodies.size(), state);
  for (std::size_t b = 0; b < after.bodies.size(); ++b) {
    if (!was_there[b]) mark_appeared(b, next);
  }
  return next;
}

FrameResult carried_over(const FrameResult& result, const Scene& before, const Scene& after) {
  FrameResult next = result;
  move(places_in(before, after), next.contacts);
  next.events.clear();
  return next;
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
