#include "sleeping.h"

#include <algorithm>

namespace mrhi {
namespace {

/// Largest speed of any point of a still body [m/s]: 5 um until it is tired. Heaps of a dozen bodies, whose
/// contacts are not fully relaxed, creep at 2 to 4 um/s.
constexpr double kMaxStillSpeed = 1e-5;
/// Time after which a still body is tired [s].
constexpr double kTiredTime = 0.5;

/// Moves the contacts of bodies that are asleep, or that are not, from one list to the other.
void move_contacts(const std::vector<char>& asleep, bool sleepers, std::vector<BodyContact>& from,
                   std::vector<BodyContact>& to) {
  const auto moving = std::partition(from.begin(), from.end(), [&](const BodyContact& contact) {
    return (asleep[contact.key.b] != 0) != sleepers;
  });
  to.insert(to.end(), moving, from.end());
  from.erase(moving, from.end());
  for (std::vector<BodyContact>* contacts : {&from, &to}) {
    std::sort(contacts->begin(), contacts->end(),
              [](const BodyContact& a, const BodyContact& b) { return a.key < b.key; });
  }
}

}  // namespace

void Sleeping::wake(const Neighbours& neighbours, double step, SimulationState& state) const {
  if (state.sleeping_contacts.empty()) return;
  bool woken = false;
  for (const int listed : neighbours.paired()) {
    const auto b = static_cast<std::size_t>(listed);
    if (!state.asleep[b] || !neighbours.may_meet_hand(b, state.bodies[b], step)) continue;
    state.asleep[b] = 0;
    woken = true;
  }
  for (bool more = true; more;) {
    more = false;
    for (const auto& [first, second] : neighbours.pairs()) {
      const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
      if (scene_.bodies[a].fixed || state.asleep[a] == state.asleep[b]) continue;
      if (!neighbours.may_meet(a, b, state.bodies, step)) continue;
      state.asleep[a] = state.asleep[b] = 0;
      more = woken = true;
    }
  }
  if (!woken) return;
  for (BodyContact& contact : state.sleeping_contacts) {
    if (!state.asleep[contact.key.b]) contact.still = 0.0;
  }
  move_contacts(state.asleep, false, state.sleeping_contacts, state.body_contacts);
}

void Sleeping::settle(const Neighbours& neighbours, double step, SimulationState& state) {
  if (!allowed_ || !count_rest(step, state)) return;
  find_tired(neighbours, step, state);
  if (std::find(tired_.begin(), tired_.end(), true) == tired_.end()) return;
  for (std::size_t b = 0; b < tired_.size(); ++b) {
    if (!tired_[b]) continue;
    state.asleep[b] = 1;
    state.bodies[b].linear_momentum.setZero();
    state.bodies[b].angular_momentum.setZero();
  }
  move_contacts(state.asleep, true, state.body_contacts, state.sleeping_contacts);
}

bool Sleeping::still(std::size_t body, const BodyState& state) const {
  const Body& b = scene_.bodies[body];
  if (b.fixed) return true;
  const double spin = b.inverse_inertia.trace() * state.angular_momentum.norm();  // upper bound
  return state.linear_momentum.norm() / b.mass + b.bounding_radius * spin < kMaxStillSpeed;
}

/// True if any contact has lasted long enough for its bodies to be tired.
bool Sleeping::count_rest(double step, SimulationState& state) const {
  bool any = false;
  for (BodyContact& contact : state.body_contacts) {
    const bool rests = contact.depth > 0.0 && still(contact.key.a, state.bodies[contact.key.a]) &&
                       still(contact.key.b, state.bodies[contact.key.b]);
    contact.still = rests ? contact.still + step : 0.0;
    any = any || contact.still >= kTiredTime;
  }
  return any;
}

/// A body is tired if one of its contacts has been loaded for long enough with both bodies still, and all
/// bodies that it may meet are tired too. Its other contacts may come and go: in a heap at rest some are on
/// the verge of touching.
void Sleeping::find_tired(const Neighbours& neighbours, double step, const SimulationState& state) {
  tired_.assign(state.bodies.size(), 0);
  for (const BodyContact& contact : state.body_contacts) {
    if (contact.still < kTiredTime) continue;
    for (const std::uint16_t body : {contact.key.a, contact.key.b}) tired_[body] = !scene_.bodies[body].fixed;
  }
  for (std::size_t b = 0; b < tired_.size(); ++b) {
    if (tired_[b] && neighbours.may_meet_hand(b, state.bodies[b], step)) tired_[b] = 0;
  }
  for (bool more = true; more;) {
    more = false;
    for (const auto& [first, second] : neighbours.pairs()) {
      const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
      if (scene_.bodies[a].fixed || tired_[a] == tired_[b] || state.asleep[a] || state.asleep[b]) continue;
      if (!neighbours.may_meet(a, b, state.bodies, step)) continue;
      tired_[a] = tired_[b] = 0;
      more = true;
    }
  }
}

void wake_all(SimulationState& state) {
  std::fill(state.asleep.begin(), state.asleep.end(), char(0));
  move_contacts(state.asleep, false, state.sleeping_contacts, state.body_contacts);
}

}  // namespace mrhi
