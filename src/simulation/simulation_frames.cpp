#include <algorithm>

#include "../tracking/hand_filter.h"
#include "frame_report.h"
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
    const HandTrack& track = state.hands[static_cast<std::size_t>(slot)];
    if (!track.active || track.appeared) continue;
    hands.emplace_back(track, slot, seconds);
    hands.back().carry(operators.carrier(static_cast<std::size_t>(slot)));
  }
  list_near_hands();
}

void Simulation::Impl::list_near_hands() {
  Neighbours::Carried carried{};
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) carried[slot] = operators.carried(slot);
  neighbours.begin_frame(state.hands, state.bodies, carried);
}

/// Advances without frames: hands stand still for hold_time and are then lost; bodies advance by whole steps
/// from the last frame.
void Simulation::Impl::pass_without_frames(Nanoseconds until) {
  if (until - state.time > kMaxGap) state.time = until;
  for (HandTrack& track : state.hands) {
    track.held = track.active;
    track.previous = track.current;
    track.path = HandPath();
    track.appeared = track.emerged = false;
  }
  isolated.clear();
  while (state.time + step_length <= until) {
    lose_hands(state.time);
    begin_hands(0.0);
    advance_step(0.0, to_seconds(step_length));
    state.time += step_length;
  }
}

void Simulation::Impl::lose_hands(Nanoseconds now) {
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    const HandTrack& track = state.hands[slot];
    const bool unseen = to_seconds(now - track.last_seen) > configuration.tracking.hold_time;
    if (track.active && unseen) end_interactions(slot, now, state, result.events);
  }
  lose_unseen_hands(now, configuration.tracking.hold_time, state.hands, result.events);
  assist.lose_hands(now, state);
}

void Simulation::Impl::report(Nanoseconds stamp) {
  result.stamp = stamp;
  operators.end_frame(state);
  report_frame({scene, hands, neighbours, finder, operators, transfer, configuration.contact.hand, state},
               result);
  leave_out_contacts_that_are_not_finite();
  reported = true;
}

void Simulation::Impl::render() {
  render_hands({scene, renderer, operators, gravity, configuration.control_display_ratio, state}, result);
  show_hands_that_are_finite();
}

}  // namespace mrhi
