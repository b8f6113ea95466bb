#include "mr_hand_interaction/simulation_state.h"

#include <algorithm>
#include <cstring>

namespace mrhi {
namespace {

class Fnv1a {
 public:
  template <typename T>
  void add(const T& value) {
    static_assert(std::is_arithmetic<T>::value || std::is_enum<T>::value, "padding has no defined bits");
    unsigned char bytes[sizeof(T)];
    std::memcpy(bytes, &value, sizeof(T));
    for (const unsigned char byte : bytes) hash_ = (hash_ ^ byte) * 1099511628211ull;
  }
  void add(const Vector3& v) {
    for (int i = 0; i < 3; ++i) add(v[i]);
  }
  void add(const Pose& pose) {
    add(pose.position);
    for (int i = 0; i < 4; ++i) add(pose.orientation.coeffs()[i]);
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 14695981039346656037ull;
};

void add_joint(const JointState& joint, Fnv1a& hash) {
  hash.add(joint.position);
  hash.add(joint.anchor);
  hash.add(joint.pushed);
  hash.add(joint.still);
  hash.add(joint.detent);
  hash.add(joint.at_limit);
  hash.add(joint.latched);
}

void add_hand(const Hand& hand, Fnv1a& hash) {
  hash.add(hand.id);
  hash.add(hand.side);
  hash.add(hand.palm);
  hash.add(hand.wrist);
  for (const Capsule& capsule : hand.capsules) {
    hash.add(capsule.start);
    hash.add(capsule.end);
    hash.add(capsule.radius);
  }
}

/// Counts also for a slot that is free: the next hand of its side takes it over.
void add_noise(const SeenNoise& noise, Side side, Fnv1a& hash) {
  if (noise.size == 0) return;
  hash.add(side);
  for (int i = 0; i < noise.size; ++i) hash.add(noise.variances[static_cast<std::size_t>(i)]);
  hash.add(noise.variance);
}

void add_filter(const FilterMemory& memory, Fnv1a& hash) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(memory.history.size); ++i) {
    add_hand(memory.history.samples[i], hash);
    hash.add(memory.history.elapsed[i]);
  }
  add_hand(memory.filtered, hash);
  for (const Vector3& velocity : memory.velocity.points) hash.add(velocity);
  hash.add(memory.velocity.turn);
  hash.add(memory.variance.position);
  hash.add(memory.variance.mixed);
  hash.add(memory.variance.speed);
  add_noise(memory.noise, memory.filtered.side, hash);
}

void add_track(const HandTrack& track, Nanoseconds now, Fnv1a& hash) {
  hash.add(track.active);
  if (!track.active) {
    add_noise(track.filter.noise, track.current.side, hash);
    return;
  }
  hash.add(track.held);
  hash.add(track.appeared);
  hash.add(track.emerged);
  hash.add(now - track.last_seen);
  add_hand(track.previous, hash);
  add_hand(track.current, hash);
  add_filter(track.filter, hash);
  if (track.filter_change) {
    hash.add(now - track.filter_change->begin);
    add_filter(track.filter_change->memory, hash);
  }
  hash.add(track.rejoin.duration);
  if (track.rejoin.duration > 0) {
    hash.add(now - track.rejoin.begin);
    add_hand(track.rejoin.from, hash);
  }
}

void add_offset(const HandOffset& offset, Nanoseconds now, Fnv1a& hash) {
  if (offset.zero()) return;
  hash.add(Pose{offset.shift, offset.lag.whole});
  hash.add(Pose{Vector3::Zero(), offset.lag.frame});
  for (const FingerOffset& finger : offset.fingers)
    for (int i = 0; i < finger.size(); ++i) hash.add(finger[i]);
  hash.add(now - offset.stamp);
  hash.add(offset.left);
  if (offset.left > 0.0) hash.add(now - offset.left_since);
}

void add_contact(const Contact& contact, Fnv1a& hash) {
  hash.add(contact.key.order());
  hash.add(contact.god_object);
  hash.add(contact.entry_normal);
  hash.add(contact.touched_from);
  hash.add(contact.axis_parameter);
  hash.add(contact.depth);
  hash.add(contact.twist);
  hash.add(contact.friction);
  hash.add(contact.struck);
  hash.add(contact.given);
  hash.add(contact.ignored);
}

void add_grip(const Grip& grip, Fnv1a& hash) {
  hash.add(grip.body);
  hash.add(grip.hand);
  hash.add(grip.by_palm);
  hash.add(grip.fingers);
  hash.add(grip.opening);
  hash.add(grip.least);
  hash.add(grip.bond);
  hash.add(grip.bears);
  for (const Vector3& pad : grip.pads) hash.add(pad);
  hash.add(grip.in_palm);
  for (const Vector3& point : grip.in_hand) hash.add(point);
  for (const Vector3& point : grip.in_body) hash.add(point);
}

void add_contact(const BodyContact& contact, Fnv1a& hash) {
  hash.add(contact.key.order());
  hash.add(contact.anchor_a);
  hash.add(contact.anchor_b);
  hash.add(contact.depth);
  hash.add(contact.friction);
  hash.add(contact.struck);
  hash.add(contact.still);
  hash.add(contact.force);
}

}  // namespace

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

void place(std::size_t body, const BodyState& placed, SimulationState& state) {
  state.bodies[body] = placed;
  forget_contacts(body, state);
  mark_appeared(body, state);
}

std::uint64_t hash(const SimulationState& state) {
  Fnv1a hash;
  hash.add(state.time - state.last_frame);
  for (const BodyState& body : state.bodies) {
    hash.add(body.pose);
    hash.add(body.linear_momentum);
    hash.add(body.angular_momentum);
    hash.add(body.pushed.linear);
    hash.add(body.pushed.angular);
    hash.add(body.appeared);
  }
  for (const JointState& joint : state.joints) add_joint(joint, hash);
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    add_track(state.hands[slot], state.time, hash);
    if (state.hands[slot].active) add_offset(state.offsets[slot], state.time, hash);
  }
  for (const Contact& contact : state.contacts) add_contact(contact, hash);
  for (const Grip& grip : state.grips) add_grip(grip, hash);
  for (const BodyContact& contact : state.body_contacts) add_contact(contact, hash);
  for (const BodyContact& contact : state.sleeping_contacts) add_contact(contact, hash);
  for (const Interaction& interaction : state.interactions) {
    hash.add(interaction.level);
    hash.add(interaction.shown_in);
    if (interaction.level >= InteractionLevel::contact) hash.add(state.time - interaction.agreed);
  }
  return hash.value();
}

}  // namespace mrhi
