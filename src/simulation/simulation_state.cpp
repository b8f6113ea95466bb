#include "mr_hand_interaction/simulation_state.h"

#include <algorithm>
#include <cstring>

namespace mrhi {
namespace {

// Members are bound by name, so that a part that gets a further one does not compile until it stands here
// too, be it among those that do not matter to the future: those of a single step, and those that others
// follow from. All of them are in state_bytes.cpp.
template <class... Items>
void leave_out(const Items&...) {}

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
  template <class First, class... Others>
  void all(const First& first, const Others&... others) {
    add(first);
    (add(others), ...);
  }
  std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 14695981039346656037ull;
};

void add_joint(const JointState& joint, Fnv1a& hash) {
  const auto& [position, anchor, pushed, effort, still, detent, at_limit, latched] = joint;
  leave_out(effort);
  hash.all(position, anchor, pushed, still, detent, at_limit, latched);
}

void add_hand(const Hand& hand, Fnv1a& hash) {
  const auto& [id, side, confidence, grab, pinch, palm, palm_width, wrist, capsules] = hand;
  leave_out(confidence, grab, pinch, palm_width);
  hash.all(id, side, palm, wrist);
  for (const auto& [start, end, radius] : capsules) hash.all(start, end, radius);
}

/// Counts also for a slot that is free: the next hand of its side takes it over.
void add_noise(const SeenNoise& noise, Side side, Fnv1a& hash) {
  const auto& [variances, size, variance] = noise;
  if (size == 0) return;
  hash.add(side);
  for (int i = 0; i < size; ++i) hash.add(variances[static_cast<std::size_t>(i)]);
  hash.add(variance);
}

void add_velocity(const HandVelocity& velocity, Fnv1a& hash) {
  const auto& [points, turn] = velocity;
  for (const Vector3& point : points) hash.add(point);
  hash.add(turn);
}

void add_filter(const FilterMemory& memory, Fnv1a& hash) {
  const auto& [history, filtered, velocity, variance, noise] = memory;
  const auto& [samples, elapsed, size] = history;
  for (std::size_t i = 0; i < static_cast<std::size_t>(size); ++i) {
    add_hand(samples[i], hash);
    hash.add(elapsed[i]);
  }
  add_hand(filtered, hash);
  add_velocity(velocity, hash);
  const auto& [position, mixed, speed] = variance;
  hash.all(position, mixed, speed);
  add_noise(noise, filtered.side, hash);
}

/// The bends are of the frame that is over.
void add_path(const HandPath& path, Fnv1a& hash) {
  const auto& [start_bend, end_bend, longest_bend, velocity, differences, intervals, order, noise, energy,
               extrapolated] = path;
  leave_out(start_bend, end_bend, longest_bend);
  hash.add(order);
  if (order == 0) return;
  add_velocity(velocity, hash);
  for (const HandVelocity& difference : differences) add_velocity(difference, hash);
  for (const double interval : intervals) hash.add(interval);
  hash.all(noise, energy, extrapolated);
}

void add_track(const HandTrack& track, Nanoseconds now, Fnv1a& hash) {
  const auto& [active, held, appeared, emerged, previous, current, last_seen, filter, rejoin, change, path,
               mean_velocity] = track;
  hash.add(active);
  if (!active) {
    add_noise(filter.noise, current.side, hash);
    return;
  }
  hash.all(held, appeared, emerged, now - last_seen);
  add_hand(previous, hash);
  add_hand(current, hash);
  add_filter(filter, hash);
  if (change) {
    const auto& [of, memory, begin] = *change;
    leave_out(of);
    hash.add(now - begin);
    add_filter(memory, hash);
  }
  const auto& [from, begin, duration] = rejoin;
  hash.add(duration);
  if (duration > 0) {
    hash.add(now - begin);
    add_hand(from, hash);
  }
  add_path(path, hash);
  add_velocity(mean_velocity, hash);
}

void add_offset(const HandOffset& offset, Nanoseconds now, Fnv1a& hash) {
  if (offset.zero()) return;
  const auto& [shift, fingers, lag, stamp, left, left_since] = offset;
  const auto& [whole, frame] = lag;
  hash.add(Pose{shift, whole});
  hash.add(Pose{Vector3::Zero(), frame});
  for (const FingerOffset& finger : fingers)
    for (int i = 0; i < finger.size(); ++i) hash.add(finger[i]);
  hash.all(now - stamp, left);
  if (left > 0.0) hash.add(now - left_since);
}

void add_contact(const ContactMemory& contact, Fnv1a& hash) {
  const auto& [key, friction, struck, ignored, god_object, entry_normal, touched_from, axis_parameter,
               at_edge, depth, twist, compliance, force] = contact;
  leave_out(at_edge, force);
  hash.all(key.order(), god_object, entry_normal, touched_from, axis_parameter, depth, twist, friction,
           struck, compliance, ignored);
}

void add_grip(const Grip& grip, Fnv1a& hash) {
  const auto& [body, hand, by_palm, fingers, touch_aperture, mean_aperture, min_aperture, bond, stiffness,
               active, released, lost, body_in_palm, closes, opened, opens, pads, in_palm_before, in_palm,
               slips, in_hand, in_body, force, torque, point, velocity] = grip;
  leave_out(stiffness, lost, closes, opened, opens, in_palm_before, slips, force, torque, point, velocity);
  hash.all(body, hand, by_palm, fingers, touch_aperture, mean_aperture, min_aperture, bond, active, released);
  if (lost) hash.add(body_in_palm);
  for (const Vector3& pad : pads) hash.add(pad);
  hash.add(in_palm);
  for (const Vector3& end : in_hand) hash.add(end);
  for (const Vector3& end : in_body) hash.add(end);
}

void add_contact(const BodyContact& contact, Fnv1a& hash) {
  const auto& [key, anchor_a, anchor_b, friction, struck, still, point, normal, arm_a, arm_b, friction_offset,
               stretch, material, depth, share, first_touch, force, impulse] = contact;
  leave_out(point, normal, arm_a, arm_b, friction_offset, stretch, material, share, first_touch, impulse);
  hash.all(key.order(), anchor_a, anchor_b, depth, friction, struck, still, force);
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

std::uint64_t hash(const SimulationState& state) {
  const auto& [started, time, last_frame, stamps, bodies, joints, asleep, restrained, hands, contacts,
               body_contacts, sleeping_contacts, offsets, mass_lags, grips, interactions] = state;
  leave_out(started, stamps, asleep);
  Fnv1a hash;
  hash.add(time - last_frame);
  for (const auto& [pose, linear_momentum, angular_momentum, pushed, appeared] : bodies)
    hash.all(pose, linear_momentum, angular_momentum, pushed.linear, pushed.angular, appeared);
  for (const JointState& joint : joints) add_joint(joint, hash);
  for (const char held : restrained) hash.add(held);
  for (std::size_t slot = 0; slot < hands.size(); ++slot) {
    add_track(hands[slot], time, hash);
    if (!hands[slot].active) continue;
    add_offset(offsets[slot], time, hash);
    const auto& [displacement, velocity, stamp] = mass_lags[slot];
    if (!mass_lags[slot].zero()) hash.all(displacement, velocity, time - stamp);
  }
  for (const Contact& contact : contacts) add_contact(contact, hash);
  for (const Grip& grip : grips) add_grip(grip, hash);
  for (const BodyContact& contact : body_contacts) add_contact(contact, hash);
  for (const BodyContact& contact : sleeping_contacts) add_contact(contact, hash);
  for (const auto& [level, agreed, shown_in] : interactions) {
    hash.all(level, shown_in);
    if (level >= InteractionLevel::contact) hash.add(time - agreed);
  }
  return hash.value();
}

}  // namespace mrhi
