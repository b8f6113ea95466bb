#include "mr_hand_interaction/simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "frame_report.h"
#include "mr_hand_interaction/collision/body_contact_finder.h"
#include "mr_hand_interaction/collision/contact_finder.h"
#include "mr_hand_interaction/integration/free_flight.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/scene_change.h"
#include "mr_hand_interaction/tracking/tracker.h"
#include "sleeping.h"

namespace mrhi {
namespace {

/// A step back in time of more than this may be a stream that begins anew; less is a frame out of order.
constexpr Nanoseconds kRestart = 500'000'000;
constexpr int kRestartFrames = 3;
/// A step may be this much longer than asked for, so that a frame of one step does not become two by
/// rounding.
constexpr Nanoseconds kStepSlack = 1000;
/// A frame of at most this in which nothing comes near anything is one step, as flight needs no more.
constexpr Nanoseconds kQuietFrame = 20'000'000;
/// A longer silence is not simulated: bodies wait for the next frame.
constexpr Nanoseconds kLongestSilence = 60'000'000'000;

Scene completed(Scene scene) {
  for (Body& body : scene.bodies) complete(body);
  return scene;
}

/// Edges grip under `implicit` alone: other models do not look at what is stored there.
ContactConfiguration refinements(const Configuration& configuration) {
  ContactConfiguration result = configuration.contact;
  result.edge_grip &= configuration.contact_model == ContactModelKind::implicit;
  return result;
}

}  // namespace

struct Simulation::Impl {
  Impl(Scene scene_in, const Configuration& configuration_in)
      : scene(completed(std::move(scene_in))),
        configuration(configuration_in),
        gravity(configuration.gravity.value_or(scene.gravity)),
        step_length(static_cast<Nanoseconds>(std::llround(configuration.step * 1e9))),
        model(make_contact_model(configuration)),
        geometry(scene),
        neighbours(scene),
        finder(scene, geometry, gravity, refinements(configuration)),
        body_finder(scene, geometry, gravity),
        sleeping(scene, configuration.contact.sleep),
        renderer(scene, finder) {
    reset();
  }

  void reset();
  Rejection judge(Nanoseconds stamp);
  void plan(Nanoseconds from, Nanoseconds to);
  int steps_needed(Nanoseconds frame);
  bool quiet(double seconds) const;
  void begin_hands(double seconds);
  void advance_step(double fraction, double step);
  void silence(Nanoseconds until);
  void lose_hands(Nanoseconds now);
  void keep_in_bounds();
  void clear_result();
  void finish(Nanoseconds stamp);

  const Scene scene;
  const Configuration configuration;
  const Vector3 gravity;
  const Nanoseconds step_length;
  const std::unique_ptr<ContactModel> model;
  const SceneGeometry geometry;
  Neighbours neighbours;
  ContactFinder finder;
  BodyContactFinder body_finder;
  Sleeping sleeping;
  HandRenderer renderer;

  SimulationState state;
  FrameResult result;

  // The way from the last frame to this one.
  Nanoseconds frame_from = 0, frame_to = 0;
  int steps = 0, steps_done = 0;

  std::vector<HandMotion> hands;  // those that can touch
  std::vector<Contact> strikes;
  StepChanges changes;
  std::function<void(Stage)> ended;
  void end_stage(Stage stage) const {
    if (ended) ended(stage);
  }
};

void Simulation::Impl::reset() {
  state = SimulationState();
  for (const Body& body : scene.bodies) state.bodies.push_back(start_state(body));
  state.asleep.assign(scene.bodies.size(), 0);
  state.hands.resize(kMaxHands);
  state.offsets.resize(kMaxHands);
  state.interactions.resize(kMaxHands * scene.bodies.size());
  state.contacts.reserve(64 * kMaxHands);
  state.body_contacts.reserve(16 * scene.bodies.size());
  state.sleeping_contacts.reserve(16 * scene.bodies.size());
  hands.reserve(kMaxHands);
  strikes.clear();
  strikes.reserve(64 * kMaxHands);
  steps = steps_done = 0;
}

/// Refuses a stamp that does not increase, unless it is the third of a stream that goes on from an earlier
/// time.
Rejection Simulation::Impl::judge(Nanoseconds stamp) {
  if (!state.started || stamp > state.time) {
    state.restart_frames = 0;
    return Rejection::none;
  }
  if (state.time - stamp <= kRestart) return Rejection::stamp_not_increasing;
  const bool follows =
      state.restart_frames > 0 && stamp > state.restart_stamp && stamp - state.restart_stamp < kRestart;
  state.restart_frames = follows ? state.restart_frames + 1 : 1;
  state.restart_stamp = stamp;
  if (state.restart_frames < kRestartFrames) return Rejection::stamp_not_increasing;
  reset();
  result.restarted = true;
  return Rejection::none;
}

void Simulation::Impl::plan(Nanoseconds from, Nanoseconds to) {
  frame_from = from;
  frame_to = to;
  steps_done = 0;
  begin_hands(to_seconds(to - from));
  steps = steps_needed(to - from);
}

int Simulation::Impl::steps_needed(Nanoseconds frame) {
  if (frame <= 0) return 0;
  if (frame <= kQuietFrame) {
    neighbours.begin_step(state.bodies, to_seconds(frame));
    if (quiet(to_seconds(frame))) return 1;
  }
  return std::max(static_cast<int>((frame - kStepSlack + step_length - 1) / step_length), 1);
}

/// True if nothing that is awake may come near a hand or a body within `seconds`.
bool Simulation::Impl::quiet(double seconds) const {
  for (std::size_t slot = 0; slot < state.hands.size(); ++slot) {
    for (const NearBody& near : neighbours.near_hand(static_cast<int>(slot))) {
      const auto b = static_cast<std::size_t>(near.body);
      if (neighbours.may_meet_hand(b, state.bodies[b], seconds)) return false;
    }
  }
  for (const auto& [first, second] : neighbours.pairs()) {
    const auto a = static_cast<std::size_t>(first), b = static_cast<std::size_t>(second);
    const bool asleep = state.asleep[b] && (state.asleep[a] || scene.bodies[a].fixed);
    if (!asleep && neighbours.may_meet(a, b, state.bodies, seconds)) return false;
  }
  return true;
}

void Simulation::Impl::begin_hands(double seconds) {
  hands.clear();
  for (int slot = 0; slot < kMaxHands; ++slot) {
    const HandTrack& track = state.hands[static_cast<std::size_t>(slot)];
    if (track.active && !track.appeared) hands.emplace_back(track, slot, seconds);
  }
  neighbours.begin_frame(state.hands, state.bodies);
}

/// One step, `fraction` of the way into the frame.
void Simulation::Impl::advance_step(double fraction, double step) {
  for (HandMotion& hand : hands) hand.move_to(fraction);
  neighbours.begin_step(state.bodies, step);
  sleeping.wake(neighbours, step, state);
  end_stage(Stage::neighbours);
  finder.find(hands, neighbours, state.bodies, step, state.contacts);
  end_stage(Stage::hand_contacts);
  body_finder.find(neighbours, state.bodies, state.asleep, step, state.body_contacts);
  end_stage(Stage::body_contacts);
  changes.reset(scene.bodies.size());
  ContactStep contact_step{scene, gravity, step, state.contacts, state.body_contacts, state.bodies, changes};
  model->respond(contact_step);
  note_strikes(state.contacts, strikes);
  end_stage(Stage::response);
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    if (state.asleep[b]) continue;
    free_flight(scene.bodies[b], changes.solved(b) ? Vector3::Zero() : gravity, step, state.bodies[b]);
  }
  changes.delay_impacts(scene.bodies, gravity, step, state.bodies);
  sleeping.settle(neighbours, step, state);
  keep_in_bounds();
  end_stage(Stage::flight);
}

/// No frames: hands keep still for hold_time and are lost then; bodies go on, by whole steps from the last
/// frame.
void Simulation::Impl::silence(Nanoseconds until) {
  if (until - state.time > kLongestSilence) state.time = until;
  for (HandTrack& track : state.hands) {
    track.held = track.active;
    track.previous = track.current;
    track.appeared = track.emerged = false;
  }
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
}

void Simulation::Impl::keep_in_bounds() {
  for (std::size_t b = 0; b < state.bodies.size(); ++b) {
    const Body& body = scene.bodies[b];
    if (body.fixed) continue;
    const Vector3& p = state.bodies[b].pose.position;
    if ((p.array() >= scene.bounds.min.array()).all() && (p.array() <= scene.bounds.max.array()).all())
      continue;
    state.bodies[b] = start_state(body);
    forget_contacts(b, state);
    result.events.push_back({state.time, EventKind::out_of_bounds, static_cast<int>(b), 0});
  }
}

void Simulation::Impl::clear_result() {
  result.stamp = 0;
  result.tracked.clear();
  result.rendered.clear();
  result.contacts.clear();
  result.events.clear();
  strikes.clear();
}

void Simulation::Impl::finish(Nanoseconds stamp) {
  result.stamp = stamp;
  report_frame({scene, hands, neighbours, finder, renderer, strikes, state}, result);
}

Simulation::Simulation(Scene scene, const Configuration& configuration)
    : impl_(std::make_unique<Impl>(std::move(scene), configuration)) {}
Simulation::~Simulation() = default;

Rejection Simulation::begin(const HandFrame& frame) {
  Impl& s = *impl_;
  s.result.restarted = false;
  const Rejection rejection = s.judge(frame.stamp);
  if (rejection != Rejection::none) return rejection;
  s.clear_result();
  if (!s.state.started) {
    s.state.started = true;
    s.state.time = s.state.last_frame = frame.stamp;
  }
  if (to_seconds(frame.stamp - s.state.last_frame) > s.configuration.tracking.hold_time)
    s.silence(frame.stamp);
  s.lose_hands(frame.stamp);
  track_hands(frame, s.configuration, s.state.hands, s.result.events);
  s.state.last_frame = frame.stamp;
  s.plan(s.state.time, frame.stamp);
  return Rejection::none;
}

bool Simulation::step() {
  Impl& s = *impl_;
  if (s.steps_done >= s.steps) return false;
  const double seconds = to_seconds(s.frame_to - s.frame_from);
  s.advance_step(static_cast<double>(s.steps_done) / s.steps, seconds / s.steps);
  ++s.steps_done;
  return true;
}

const FrameResult& Simulation::end() {
  Impl& s = *impl_;
  s.state.time = s.frame_to;
  s.finish(s.frame_to);
  return s.result;
}

Rejection Simulation::advance(const HandFrame& frame) {
  const Rejection rejection = begin(frame);
  if (rejection != Rejection::none) return rejection;
  while (step()) {
  }
  end();
  return rejection;
}

const FrameResult& Simulation::result() const {
  return impl_->result;
}

double Simulation::deepest_rendered() const {
  double deepest = 0.0;
  for (const RenderedHand& rendered : impl_->result.rendered)
    deepest = std::max(deepest,
                       deepest_penetration(rendered.hand, impl_->finder, impl_->scene, impl_->state.bodies));
  return deepest;
}

bool Simulation::advance_without_hands(Nanoseconds time) {
  Impl& s = *impl_;
  const SimulationState& state = s.state;
  if (!state.started || to_seconds(time - state.last_frame) <= s.configuration.tracking.hold_time)
    return false;
  if (time < state.time + s.step_length) return false;
  s.result.restarted = false;
  s.clear_result();
  s.silence(time);
  s.finish(state.time);
  return true;
}

void Simulation::reset() {
  impl_->reset();
  impl_->clear_result();
}

void Simulation::watch(std::function<void(Stage)> ended) {
  impl_->ended = std::move(ended);
}

const Scene& Simulation::scene() const {
  return impl_->scene;
}
const Configuration& Simulation::configuration() const {
  return impl_->configuration;
}
const SimulationState& Simulation::state() const {
  return impl_->state;
}
Nanoseconds Simulation::time() const {
  const Impl& s = *impl_;
  if (s.steps_done == 0 || s.state.time >= s.frame_to) return s.state.time;
  return s.frame_from + (s.frame_to - s.frame_from) * s.steps_done / s.steps;
}
void Simulation::set_state(const SimulationState& state) {
  impl_->state = state;
  impl_->state.asleep.resize(impl_->scene.bodies.size(), 0);
  impl_->steps = impl_->steps_done = 0;
}
void Simulation::go_on_from(const Simulation& other) {
  set_state(carried_over(other.state(), other.scene(), scene()));
  impl_->result = carried_over(other.result(), other.scene(), scene());
}

const char* to_string(Stage stage) {
  switch (stage) {
    case Stage::neighbours:
      return "neighbours";
    case Stage::hand_contacts:
      return "hand contacts";
    case Stage::body_contacts:
      return "body contacts";
    case Stage::response:
      return "response";
    case Stage::flight:
      break;
  }
  return "flight";
}

const char* to_string(Rejection rejection) {
  return rejection == Rejection::none ? "none" : "stamp not increasing";
}

}  // namespace mrhi
