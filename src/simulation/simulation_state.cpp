#include "mr_hand_interaction/simulation_state.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mr_hand_interaction/scene/save_scene.h"
#include "state_bytes.h"

namespace mrhi {
bool is_held(std::size_t body, const SimulationState& state) {
  for (std::size_t i = body; i < state.interactions.size(); i += state.bodies.size()) {
    if (state.interactions[i].level == InteractionLevel::grasp) return true;
  }
  return false;
}

void forget_contacts(std::size_t body, SimulationState& state) {
  wake_all(state);
  const auto forget = [](auto& contacts, const auto& concerns) {
    contacts.erase(std::remove_if(contacts.begin(), contacts.end(), concerns), contacts.end());
  };
  forget(state.contacts, [body](const Contact& contact) { return contact.key.body == body; });
  forget(state.grips, [body](const Grip& grip) { return grip.body == body; });
  forget(state.body_contacts,
         [body](const BodyContact& contact) { return contact.key.a == body || contact.key.b == body; });
}

void mark_appeared(std::size_t body, SimulationState& state) {
  state.bodies[body].appeared = true;
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot)
    state.interactions[slot * state.bodies.size() + body].shown_in = state.hands[slot].active;
}

void mark_hands_appeared(SimulationState& state) {
  state.contacts.clear();
  state.grips.clear();
  for (HandTrack& track : state.hands) track.appeared = track.active;
}

void place(std::size_t body, const BodyState& placed, SimulationState& state) {
  state.bodies[body] = placed;
  forget_contacts(body, state);
  mark_appeared(body, state);
}

Scene scene_as_it_is(const Scene& scene, const std::vector<BodyState>& bodies,
                     const std::vector<JointState>& joints) {
  Scene now = scene;
  for (std::size_t b = 0; b < now.bodies.size(); ++b) {
    if (now.bodies[b].fixed) continue;
    now.bodies[b].start = bodies[b].pose;
    now.bodies[b].start_twist = twist_of(scene.bodies[b], bodies[b]);
  }
  for (std::size_t j = 0; j < now.joints.size(); ++j) {
    Joint& joint = now.joints[j];
    joint.start = std::min(std::max(joints[j].position, joint.lower), joint.upper);
  }
  return now;
}

namespace {

bool is_unit(const Quaternion& q) {
  constexpr double kRounding = 1e-3;  // for trackers that send 32 bits
  return std::abs(q.norm() - 1.0) <= kRounding;
}

/// Checks that everything a state refers to is in its scene.
class Fit {
 public:
  explicit Fit(const Scene& scene) : scene_(scene) {}

  bool operator()(const SimulationState& state) const {
    return sizes(state) && all(state.bodies) && all(state.joints) && all(state.hands) && all(state.offsets) &&
           all(state.contacts) && sorted(state.contacts) && all(state.body_contacts) &&
           sorted(state.body_contacts) && all(state.sleeping_contacts) && all(state.grips) &&
           std::is_sorted(state.grips.begin(), state.grips.end(), [](const Grip& a, const Grip& b) {
             return std::make_pair(a.hand, a.body) < std::make_pair(b.hand, b.body);
           });
  }

 private:
  template <class Items>
  bool all(const Items& items) const {
    return std::all_of(items.begin(), items.end(), [this](const auto& item) { return this->one(item); });
  }
  template <class Contacts>
  static bool sorted(const Contacts& contacts) {
    return std::adjacent_find(contacts.begin(), contacts.end(), [](const auto& a, const auto& b) {
             return !(a.key < b.key);
           }) == contacts.end();
  }
  bool sizes(const SimulationState& state) const {
    const std::size_t bodies = scene_.bodies.size(), hands = kMaxHands;
    return state.bodies.size() == bodies && state.asleep.size() == bodies && state.hands.size() == hands &&
           state.offsets.size() == hands && state.mass_lags.size() == hands &&
           state.interactions.size() == hands * bodies && state.joints.size() == scene_.joints.size() &&
           state.restrained.size() == scene_.operators.size();
  }
  bool is_shape(std::size_t body, std::size_t shape) const {
    return body < scene_.bodies.size() && shape < scene_.bodies[body].shapes.size();
  }
  bool moves(std::size_t body) const { return body < scene_.bodies.size() && !scene_.bodies[body].fixed; }
  bool one(const BodyState& body) const { return is_unit(body.pose.orientation); }
  bool one(const JointState& joint) const { return joint.at_limit >= -1 && joint.at_limit <= 1; }
  bool one(const HandTrack& track) const {
    return !track.active ||
           (is_unit(track.previous.palm.orientation) && is_unit(track.current.palm.orientation));
  }
  bool one(const HandOffset& offset) const { return is_unit(offset.lag.whole) && is_unit(offset.lag.frame); }
  bool one(const Contact& contact) const {
    const ContactKey& key = contact.key;
    return is_shape(key.body, key.shape) && key.hand < kMaxHands && key.capsule < kCapsules;
  }
  bool one(const BodyContact& contact) const {
    const BodyContactKey& key = contact.key;
    return is_shape(key.a, key.shape_a) && is_shape(key.b, key.shape_b) && moves(key.b) && key.a != key.b;
  }
  bool one(const Grip& grip) const {
    return moves(grip.body) && grip.hand < kMaxHands && grip.fingers != 0 && grip.fingers < 1 << kFingers;
  }

  const Scene& scene_;
};

}  // namespace

bool fits(const SimulationState& state, const Scene& scene) {
  return Fit(scene)(state);
}

}  // namespace mrhi
