#include "mr_hand_interaction/simulation.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "../joints/joint_law.h"
#include "../text/text.h"
#include "../tracking/hand_filter.h"
#include "simulation_impl.h"

namespace mrhi {
namespace {

/// Longest frame in which isolated bodies fly in one step (isolated_bodies.h), and which is a single step if
/// nothing comes near anything [ns]. Scenes with joints always use the configured step.
constexpr Nanoseconds kQuietFrame = 20'000'000;

Scene completed(Scene scene) {
  for (Body& body : scene.bodies) complete(body);
  arrange_joints(scene);
  return scene;
}

/// Edges grip only in the model `implicit`: others do not use what is stored there. The paper has one god
/// object for each phalanx, on the nearest face.
ContactConfiguration refinements(const Configuration& configuration) {
  ContactConfiguration result = configuration.contact;
  const bool implicit = configuration.contact_model == ContactModelKind::implicit;
  result.edge_grip &= implicit;
  if (!is_literal(configuration)) return result;
  result.anchors = true;
  result.entry_face = result.two_points = result.swing_back = false;
  return result;
}

/// Limits for steps set in code. Parameters set by name have closer limits (parameters.h).
Nanoseconds checked_step(double step) {
  constexpr double kMinStep = 1e-6, kMaxStep = 1.0;  // [s]
  if (step >= kMinStep && step <= kMaxStep) return static_cast<Nanoseconds>(std::llround(step * 1e9));
  throw std::invalid_argument("step " + text::number(step) + " s is not allowed; allowed: " +
                              text::number(kMinStep) + " to " + text::number(kMaxStep));
}

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

/// Keeps the items for which `stays` returns true; it also renumbers their bodies.
template <typename Item, typename Stays>
void keep_if(std::vector<Item>& items, const Stays& stays) {
  const auto is_gone = [&](Item& item) { return !stays(item); };
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

/// The state of a simulation of `before` as that of one of `after`. A body that both have by name keeps its
/// pose, momentum, contacts with their memory, and interactions to the bit; bodies that both have must be in
/// the same order. All are awake. A body that only `after` has is at its start and has appeared there.
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
  keep_if(next.contacts, [&](Contact& contact) { return renumber(places, contact.key.body); });
  keep_if(next.body_contacts, [&](BodyContact& contact) {
    return renumber(places, contact.key.a) && renumber(places, contact.key.b);
  });
  keep_if(next.grips, [&](Grip& grip) { return renumber(places, grip.body); });
  next.interactions = moved(places, after.bodies.size(), state);
  for (std::size_t b = 0; b < after.bodies.size(); ++b) {
    if (!was_there[b]) mark_appeared(b, next);
  }
  return next;
}

/// The last result likewise, without its events.
FrameResult carried_over(const FrameResult& result, const Scene& before, const Scene& after) {
  FrameResult next = result;
  const Places places = places_in(before, after);
  keep_if(next.contacts, [&](Contact& contact) { return renumber(places, contact.key.body); });
  next.events.clear();
  return next;
}

}  // namespace

Simulation::Impl::Impl(Scene scene_in, const Configuration& configuration_in)
    : scene(completed(std::move(scene_in))),
      configuration(configuration_in),
      gravity(configuration.gravity.value_or(scene.gravity)),
      step_length(checked_step(configuration.step)),
      model(make_contact_model(configuration, scene, state, result.events)),
      quiet_frame(scene.joints.empty() ? kQuietFrame : 0),
      geometry(scene),
      neighbours(scene),
      finder(scene, geometry, gravity, refinements(configuration)),
      body_finder(scene, geometry, gravity),
      operators(scene),
      isolated(scene),
      sleeping(scene, configuration.contact.sleep),
      assist(scene, finder, operators, configuration),
      renderer(scene, finder) {
  hand_filter(configuration.filter.type);  // refuses an unknown one
  reset();
}

void Simulation::Impl::reset() {
  state = SimulationState();
  for (const Body& body : scene.bodies) state.bodies.push_back(start_state(body));
  for (const Joint& joint : scene.joints) state.joints.push_back(start_state(joint));
  state.asleep.assign(scene.bodies.size(), 0);
  state.restrained.assign(scene.operators.size(), 0);
  state.hands.resize(kMaxHands);
  state.offsets.resize(kMaxHands);
  state.mass_lags.resize(kMaxHands);
  state.interactions.resize(kMaxHands * scene.bodies.size());
  state.grips.reserve(kMaxHands * scene.bodies.size());
  state.contacts.reserve(64 * kMaxHands);
  state.body_contacts.reserve(16 * scene.bodies.size());
  state.sleeping_contacts.reserve(16 * scene.bodies.size());
  hands.reserve(kMaxHands);
  transfer.clear();
  transfer.contacts.reserve(64 * kMaxHands);
  steps = steps_done = 0;
}

void Simulation::Impl::clear_result() {
  result.stamp = 0;
  result.tracked.clear();
  result.rendered.clear();
  result.contacts.clear();
  result.events.clear();
  result.assists.clear();
  result.not_finite.clear();
  reported = false;
  transfer.clear();
}

Simulation::Simulation(Scene scene, const Configuration& configuration)
    : impl_(std::make_unique<Impl>(std::move(scene), configuration)) {}
Simulation::~Simulation() = default;

Rejection Simulation::begin(const HandFrame& frame, const std::optional<Nanoseconds>& expected) {
  Impl& s = *impl_;
  s.result.restarted = false;
  const double hold_time = s.hold_time();  // by the interval before this frame
  const Rejection rejection = s.check_stamp(frame.stamp, expected);
  if (rejection != Rejection::none) return rejection;
  s.clear_result();
  if (!s.state.started) {
    s.state.started = true;
    s.state.time = s.state.last_frame = frame.stamp;
  }
  if (to_seconds(frame.stamp - s.state.last_frame) > hold_time) s.pass_without_frames(frame.stamp, hold_time);
  s.lose_hands(frame.stamp, hold_time);
  const double elapsed = to_seconds(frame.stamp - s.state.last_frame);
  const auto people = static_cast<std::uint32_t>(std::max<std::size_t>(s.scene.operators.size(), 1));
  track_hands(frame, elapsed, people, s.configuration, s.state.hands, s.result.events);
  s.lose_hands_that_are_not_finite(frame.stamp);
  s.state.last_frame = frame.stamp;
  s.plan(s.state.time, frame.stamp);
  return Rejection::none;
}

bool Simulation::step() {
  Impl& s = *impl_;
  if (s.steps_done >= s.steps) return false;
  s.advance_step(static_cast<double>(s.steps_done) / s.steps, s.frame_seconds() / s.steps);
  ++s.steps_done;
  return true;
}

const FrameResult& Simulation::report() {
  Impl& s = *impl_;
  if (s.reported) return s.result;
  s.state.time = s.frame_to;
  s.report(s.frame_to);
  return s.result;
}

const FrameResult& Simulation::end() {
  report();
  impl_->render();
  return impl_->result;
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
  const Impl& s = *impl_;
  double deepest = 0.0;
  auto rendered = s.result.rendered.begin();
  for (std::size_t slot = 0; slot < s.state.hands.size(); ++slot) {
    if (!s.state.hands[slot].active || rendered == s.result.rendered.end()) continue;
    const Interaction* interactions = s.state.interactions.data() + slot * s.state.bodies.size();
    deepest = std::max(
        deepest, deepest_penetration((rendered++)->hand, s.finder, s.scene, s.state.bodies, interactions));
  }
  return deepest;
}

bool Simulation::advance_without_hands(Nanoseconds time) {
  Impl& s = *impl_;
  const SimulationState& state = s.state;
  if (!state.started || time < state.time + s.step_length || time > StampCheck::kLatest) return false;
  if (to_seconds(time - state.last_frame) <= s.hold_time()) return false;
  s.result.restarted = false;
  s.clear_result();
  s.pass_without_frames(time, s.hold_time());
  s.report(state.time);
  s.render();
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
  impl_->state.restrained.resize(impl_->scene.operators.size(), 0);
  if (state.joints.size() != impl_->scene.joints.size()) {
    impl_->state.joints.clear();
    for (const Joint& joint : impl_->scene.joints) impl_->state.joints.push_back(start_state(joint));
  }
  impl_->steps = impl_->steps_done = 0;
}
void Simulation::go_on_from(const Simulation& other) {
  set_state(carried_over(other.state(), other.scene(), scene()));
  impl_->result = carried_over(other.result(), other.scene(), scene());
}

const char* to_string(Stage stage) {
  static const char* const names[kStages] = {"neighbours", "hand contacts", "body contacts", "response",
                                             "flight"};
  return names[static_cast<std::size_t>(stage)];
}

const char* to_string(Rejection rejection) {
  static const char* const names[] = {"none", "stamp not increasing", "stamp far ahead",
                                      "stamp out of range"};
  return names[static_cast<std::size_t>(rejection)];
}

}  // namespace mrhi
