#include <algorithm>

#include "../integration/free_flight.h"
#include "../joints/linkage.h"
#include "../tracking/hand_filter.h"
#include "simulation_impl.h"

namespace mrhi {
namespace {

/// Tolerance of a step's length, so that rounding does not split a frame of one step [ns].
constexpr Nanoseconds kStepTolerance = 1000;
/// Longest gap between frames that is simulated; bodies wait in a longer one [ns].
constexpr Nanoseconds kMaxGap = 60'000'000'000;

}  // namespace

Rejection Simulation::Impl::check_stamp(Nanoseconds stamp, const std::optional<Nanoseconds>& expected) {
  switch (state.stamps.check(stamp, state.time, expected)) {
    case StampVerdict::late:
    case StampVerdict::behind:
      return Rejection::stamp_not_increasing;
    case StampVerdict::ahead:
      return Rejection::stamp_ahead;
    case StampVerdict::no_time:
      return Rejection::no_stamp;
    case StampVerdict::restart: {
      const StampCheck stamps = state.stamps;
      reset();
      state.stamps = stamps;
      result.restarted = true;
      break;
    }
    case StampVerdict::follows:
      break;
  }
  return Rejection::none;
}

void Simulation::Impl::plan(Nanoseconds from, Nanoseconds to) {
  frame_from = from;
  frame_to = to;
  steps_done = 0;
  begin_hands(to_seconds(to - from));
  assist.begin_frame(neighbours, to_seconds(to - from), state);
  steps = steps_needed(to - from);
}

int Simulation::Impl::steps_needed(Nanoseconds frame) {
  isolated.clear();
  if (frame <= 0) return 0;
  if (frame <= quiet_frame) {
    neighbours.begin_step(state.bodies, to_seconds(frame));
    if (isolated.begin_frame(neighbours, to_seconds(frame), state)) return 1;
    if (!may_isolate()) isolated.clear();
  }
  return std::max(static_cast<int>((frame - kStepTolerance + step_length - 1) / step_length), 1);
}

void Simulation::Impl::begin_hands(double seconds) {
  hands.clear();
  operators.begin_frame(seconds > 0.0 ? seconds : to_seconds(step_length), state);
  for (int slot = 0; slot < kMaxHands; ++slot) {
    const HandTrack& track = state.hands[slot];
    if (!track.active || track.appeared) continue;
    hands.emplace_back(track, slot, seconds);
    hands.back().carry(operators.carrier(slot));
  }
  list_near_hands();
}

void Simulation::Impl::list_near_hands() {
  Neighbours::Carried carried{};
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) carried[slot] = operators.carried(slot);
  neighbours.begin_frame(state.hands, state.bodies, carried);
}

/// The stream's interval counts up to that of three frames a second: a longer one is a gap.
double Simulation::Impl::hold_time() const {
  constexpr double kIntervals = 1.5, kMaxInterval = 0.34;  // [s]
  return std::max(configuration.tracking.hold_time,
                  kIntervals * std::min(to_seconds(state.stamps.interval), kMaxInterval));
}

/// Advances without frames: hands stand still for hold_time and are then lost; bodies advance by whole steps
/// from the last frame.
void Simulation::Impl::pass_without_frames(Nanoseconds until, double hold_time) {
  if (until - state.time > kMaxGap) state.time = until;
  for (HandTrack& track : state.hands) {
    track.held = track.active;
    track.previous = track.current;
    track.path = HandPath();
    track.appeared = track.emerged = false;
  }
  isolated.clear();
  while (state.time + step_length <= until) {
    lose_hands(state.time, hold_time);
    begin_hands(0.0);
    advance_step(0.0, to_seconds(step_length));
    state.time += step_length;
  }
}

void Simulation::Impl::lose_hands(Nanoseconds now, double hold_time) {
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    const HandTrack& track = state.hands[slot];
    const bool unseen = to_seconds(now - track.last_seen) > hold_time;
    if (track.active && unseen) end_interactions(slot, now);
  }
  lose_unseen_hands(now, hold_time, state.hands, result.events);
  assist.lose_hands(now, state);
}

/// Limit of the change of a body's velocity by hands within the step [m/s]: to the hand's velocity, and by
/// the springs that hold it if they release it.
double Simulation::Impl::driven(double step) const {
  double limit = 0.0;
  if (neighbours.pairs().empty()) return limit;  // no body can hit another
  const auto release_velocity = [&](std::size_t body, const Vector3& force) {
    return step * force.norm() / scene.bodies[body].mass;
  };
  for (const Contact& contact : state.contacts) {
    if (scene.bodies[contact.key.body].fixed) continue;
    limit = std::max(limit, contact.hand_velocity.norm() + release_velocity(contact.key.body, contact.force));
  }
  for (const Grip& grip : state.grips) {
    if (!grip.active) continue;
    for (const Vector3& velocity : grip.velocity)
      limit = std::max(limit, velocity.norm() + release_velocity(grip.body, grip.force));
  }
  return limit;
}

/// Runs one step that begins at `fraction` of the frame.
void Simulation::Impl::advance_step(double fraction, double step) {
  const double until = frame_seconds() > 0.0 ? std::min(1.0, fraction + step / frame_seconds()) : fraction;
  if (!operators.none()) {
    const double left = frame_seconds() > 0.0 ? (1.0 - fraction) * frame_seconds() : step;
    if (!operators.begin_step(left, state)) {
      operators.predict(left);
      list_near_hands();
    }
  }
  for (HandMotion& hand : hands) hand.move_to(fraction, until);
  neighbours.begin_step(state.bodies, step);
  isolated.join(neighbours, fraction * frame_seconds(), step, gravity, state);
  sleeping.wake(neighbours, step, state);
  end_stage(Stage::neighbours);
  finder.find(hands, neighbours, state.bodies, step, state.contacts);
  assist.begin_step(fraction, step, state);
  if (!operators.none()) operators.begin_contacts(state);
  end_stage(Stage::hand_contacts);
  body_finder.find(neighbours, state.bodies, state.asleep, step, driven(step), state.body_contacts);
  end_stage(Stage::body_contacts);
  changes.reset(scene.bodies.size());
  ContactStep contact_step{
      scene,        gravity, step,        configuration.contact,      state.contacts, state.body_contacts,
      state.bodies, changes, state.grips, operators.bodies_of_hands()};
  model->respond(contact_step);
  if (!may_isolate()) operators.respond(contact_step, state.restrained);
  end_stage(Stage::response);
  transfer.add(state, step);
  const bool last = steps_done + 1 >= steps;
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    state.bodies[b].appeared = false;
    if (state.asleep[b] || (isolated[b] && !last)) continue;
    free_flight(scene.bodies[b], changes.solved(b) ? Vector3::Zero() : gravity,
                isolated[b] ? frame_seconds() : step, state.bodies[b]);
  }
  changes.delay_impacts(scene.bodies, gravity, step, state.bodies);
  sleeping.settle(neighbours, step, state);
  keep_in_bounds();
  end_stage(Stage::flight);
}

void Simulation::Impl::keep_in_bounds() {
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const bool sound = is_finite(state.bodies[b]);
    if (sound && scene.bounds.contains(state.bodies[b].pose.position)) continue;
    const Body& body = scene.bodies[b];  // read late: in large scenes it is not in the cache
    if (body.fixed) continue;
    if (!sound) result.not_finite.push_back("object '" + body.name + "'");
    put_back(b, scene, state);
    if (body.is_operator) {
      mark_hands_appeared(state);
      hands.clear();
    }
    result.events.push_back({state.time, EventKind::out_of_bounds, static_cast<int>(b), 0});
  }
}

}  // namespace mrhi
