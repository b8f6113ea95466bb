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

/// True if forces of its own may hold a joint at rest.
bool may_hold(const Joint& joint, const JointState& state) {
  return joint.friction > 0.0 || joint.damping > 0.0 || joint.spring || joint.detents || state.latched ||
         state.at_limit != 0;
}

}  // namespace

void Sleeping::wake(const Neighbours& neighbours, double step, SimulationState& state) const {
  if (std::find(state.asleep.begin(), state.asleep.end(), 1) == state.asleep.end()) return;
  bool woken = false;
  for (std::size_t b = 0; b < state.asleep.size(); ++b) {
    if (!state.asleep[b] || !neighbours.may_meet_hand(b, state.bodies[b], step)) continue;
    state.asleep[b] = 0;
    woken = true;
  }
  if (!(clear_connected(neighbours, step, state.bodies, nullptr, state.asleep) || woken)) return;
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

bool Sleeping::still(int body, const SimulationState& state) const {
  if (is_ground(body)) return true;
  const Body& b = scene_.bodies[body];
  const BodyState& now = state.bodies[body];
  const double spin = b.inverse_inertia.trace() * now.angular_momentum.norm();  // upper bound
  return now.linear_momentum.norm() / b.mass + b.bounding_radius * spin < kMaxStillSpeed;
}

/// True if any contact or joint has been still for long enough for its bodies to be tired.
bool Sleeping::count_rest(double step, SimulationState& state) const {
  bool any = false;
  for (BodyContact& contact : state.body_contacts) {
    const bool at_rest = contact.depth > 0.0 && still(contact.key.a, state) && still(contact.key.b, state);
    contact.still = at_rest ? contact.still + step : 0.0;
    any = any || contact.still >= kTiredTime;
  }
  for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
    const Joint& joint = scene_.joints[j];
    if (state.asleep[joint.child]) continue;
    double& lasted = state.joints[j].still;
    lasted = still(joint.parent, state) && still(joint.child, state) ? lasted + step : 0.0;
    any = any || lasted >= kTiredTime;
  }
  return any;
}

/// From the world and fixtures along joints that hold, and from tired bodies along any joint, all still for
/// long enough. A freely floating linkage has no such joint, so only contacts can make it tired.
void Sleeping::follow_joints(const SimulationState& state) {
  for (bool more = true; more;) {
    more = false;
    for (std::size_t j = 0; j < scene_.joints.size(); ++j) {
      const Joint& joint = scene_.joints[j];
      if (state.joints[j].still < kTiredTime || state.asleep[joint.child]) continue;
      const bool on_ground = is_ground(joint.parent), child = tired_[joint.child] != 0;
      const bool parent = on_ground ? may_hold(joint, state.joints[j]) : tired_[joint.parent] != 0;
      if (parent == child || (on_ground && child)) continue;
      tired_[joint.child] = 1;
      if (!on_ground) tired_[joint.parent] = 1;
      more = true;
    }
  }
}

/// A body is tired if a joint holds it, or one of its contacts has been loaded, for long enough with both
/// bodies still, and all bodies that it may meet or that are joined to it are tired too. Its other contacts
/// may come and go: in a heap at rest some are on the verge of touching.
void Sleeping::find_tired(const Neighbours& neighbours, double step, const SimulationState& state) {
  tired_.assign(state.bodies.size(), 0);
  for (const BodyContact& contact : state.body_contacts) {
    if (contact.still < kTiredTime) continue;
    for (const std::uint16_t body : {contact.key.a, contact.key.b}) tired_[body] = !scene_.bodies[body].fixed;
  }
  follow_joints(state);
  for (std::size_t b = 0; b < tired_.size(); ++b) {
    if (tired_[b] && neighbours.may_meet_hand(b, state.bodies[b], step)) tired_[b] = 0;
  }
  clear_connected(neighbours, step, state.bodies, &state.asleep, tired_);
}

/// Clears the flags of bodies that may meet one without a flag, or that joints connect to it. True if any was
/// cleared.
bool Sleeping::clear_connected(const Neighbours& neighbours, double step,
                               const std::vector<BodyState>& bodies, const std::vector<char>* ignored,
                               std::vector<char>& flags) const {
  bool any = false;
  const auto differ = [&](std::size_t a, std::size_t b) {
    return flags[a] != flags[b] && !(ignored != nullptr && ((*ignored)[a] || (*ignored)[b]));
  };
  for (bool more = true; more;) {
    more = false;
    const auto clear = [&](std::size_t a, std::size_t b) {
      flags[a] = flags[b] = 0;
      more = any = true;
    };
    for (const auto& [a, b] : neighbours.pairs()) {
      if (!scene_.bodies[a].fixed && differ(a, b) && neighbours.may_meet(a, b, bodies, step)) clear(a, b);
    }
    for (const Joint& joint : scene_.joints) {
      if (!is_ground(joint.parent) && differ(joint.parent, joint.child)) clear(joint.parent, joint.child);
    }
  }
  return any;
}

void wake_all(SimulationState& state) {
  std::fill(state.asleep.begin(), state.asleep.end(), char(0));
  for (JointState& joint : state.joints) joint.still = 0.0;
  move_contacts(state.asleep, false, state.sleeping_contacts, state.body_contacts);
}

}  // namespace mrhi
