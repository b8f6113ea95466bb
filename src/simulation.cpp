#include "mr_hand_interaction/simulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "frame_report.h"
#include "mr_hand_interaction/scene_change.h"
#include "mr_hand_interaction/tracking/tracker.h"
#include "simulation_impl.h"

namespace mrhi {
namespace {

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

Simulation::Impl::Impl(Scene scene_in, const Configuration& configuration_in)
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

void Simulation::Impl::clear_result() {
  result.stamp = 0;
  result.tracked.clear();
  result.rendered.clear();
  result.contacts.clear();
  result.events.clear();
  strikes.clear();
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
