#include "mr_hand_interaction/live_simulation.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "../collision/overlap.h"
#include "../scene/limits.h"
#include "../text/text.h"
#include "../tracking/hand_filter.h"
#include "mr_hand_interaction/parameters.h"
#include "mr_hand_interaction/response/contact_model.h"
#include "mr_hand_interaction/scene/scene.h"

namespace mrhi {
namespace {

void check_in_bounds(const std::string& name, const Vector3& place, const Bounds& bounds) {
  if (bounds.contains(place)) return;
  throw std::invalid_argument("'" + name + "': " + text::vector(place) + " m is out of bounds; allowed: " +
                              text::vector(bounds.min) + " to " + text::vector(bounds.max));
}

Pose checked_pose(const std::string& name, const Pose& pose, const Bounds& bounds) {
  check_in_bounds(name, pose.position, bounds);
  const double size = pose.orientation.norm();
  if (!(std::abs(size - 1.0) < 0.01))
    throw std::invalid_argument("'" + name + "': orientation " + text::quaternion(pose.orientation) +
                                " is not allowed; allowed: a unit quaternion [x, y, z, w]");
  return {pose.position, pose.orientation.normalized()};
}

/// Searches of meshes for one spawn: a few milliseconds, as frames wait meanwhile. Beyond them each pair
/// still has SearchBudget::kMinSample: what they do not find, the contacts push apart.
constexpr double kSearchesOfSpawn = 3000.0;

/// Throws std::invalid_argument if one of the bodies from `added` on overlaps one of those before.
void check_free_places(const Simulation& simulation, std::size_t added) {
  const Scene& scene = simulation.scene();
  const std::vector<BodyState>& states = simulation.state().bodies;
  const SceneGeometry geometry(scene);
  double left = kSearchesOfSpawn;
  for (std::size_t a = added; a < scene.bodies.size(); ++a) {
    for (std::size_t b = 0; b < added; ++b) {
      const Body &body = scene.bodies[a], &other = scene.bodies[b];
      const double distance = (states[b].pose.position - states[a].pose.position).norm();
      if (distance > body.bounding_radius + other.bounding_radius || (body.fixed && other.fixed)) continue;
      SearchBudget budget;
      budget.left = std::max(left, SearchBudget::kMinSample);
      const Overlap found = overlap(scene, geometry, states, a, b, budget);
      left -= budget.spent;
      if (found.is_allowed()) continue;
      throw std::invalid_argument(
          "'" + body.name + "' would be " +
          (found.shares_walls ? "inside thin walls of '" : text::number(found.depth) + " m in '") +
          other.name + "'; allowed: a place that is free");
    }
  }
}

std::size_t known_body(const Scene& scene, const std::string& name, bool free_only) {
  std::vector<std::string> names;
  for (std::size_t b = 0; b < scene.bodies.size(); ++b) {
    if (free_only && scene.bodies[b].fixed) continue;
    if (scene.bodies[b].name == name) return b;
    names.push_back(scene.bodies[b].name);
  }
  throw std::invalid_argument("no object '" + text::one_line(name, 60) +
                              "'; allowed: " + text::joined_or_none(names));
}

void check_no_joint(const Scene& scene, int body) {
  for (const Joint& joint : scene.joints) {
    if (joint.child != body && joint.parent != body) continue;
    throw std::invalid_argument("'" + scene.bodies[body].name + "' cannot be placed: joint '" + joint.name +
                                "' holds it; allowed: objects without joints");
  }
}

const std::string kGrasp = "grasp/";  // prefix of parameters of single objects

std::size_t graspable_body(const std::string& name, const std::string& object, const Scene& scene) {
  const std::vector<std::string> known = graspable_bodies(scene);
  if (std::find(known.begin(), known.end(), object) != known.end())
    return static_cast<std::size_t>(*find_body(scene, object));
  throw ParameterError("parameter '" + text::one_line(name, 60) + "': no object '" +
                       text::one_line(object, 60) +
                       "' that can be grasped by itself; allowed: " + text::joined_or_none(known));
}

void set_grasp(const std::string& name, const std::string& object, const std::string& value, Scene& scene) {
  Body& body = scene.bodies[graspable_body(name, object, scene)];
  const auto mode = grasp_mode(value);
  if (!mode)
    throw ParameterError("parameter '" + name + "': " + text::one_line(value, 60) +
                         " is not allowed; allowed: " + kGraspModes);
  body.grasp = *mode;
}

/// Sets the material of bodies that follow the parameters. Throws std::invalid_argument that names a body
/// whose own values conflict with it.
void set_default_material(const Material& material, Scene& scene) {
  for (Body& body : scene.bodies) {
    for (const MaterialField& field : material_fields())
      if (!(body.own_material.*field.own)) body.material.*field.value = material.*field.value;
    if (const auto conflict = material_conflict(body.material))
      throw std::invalid_argument("body '" + body.name + "': " + *conflict);
  }
}

bool same_filter(const Configuration& a, const Configuration& b) {
  if (is_literal(a) != is_literal(b)) return false;
  const std::string prefix = "filter/";
  for (const std::string& name : parameter_names()) {
    if (name.compare(0, prefix.size(), prefix) == 0 && parameter_text(a, name) != parameter_text(b, name))
      return false;
  }
  return true;
}

}  // namespace

std::optional<std::string> grasp_parameter(const std::string& name) {
  if (name.compare(0, kGrasp.size(), kGrasp) != 0) return {};
  return name.substr(kGrasp.size());
}

LiveSimulation::LiveSimulation(Scene scene, const Configuration& configuration)
    : simulation_(std::make_unique<Simulation>(std::move(scene), configuration)) {}

void LiveSimulation::set_parameters(const std::vector<std::pair<std::string, std::string>>& values) {
  Configuration configuration = simulation_->configuration();
  Scene scene = simulation_->scene();
  for (const auto& [name, value] : values) {
    if (const auto object = grasp_parameter(name)) {
      set_grasp(name, *object, value, scene);
    } else {
      set_parameter(configuration, name, value);
    }
  }
  validate(configuration);
  try {
    set_default_material(default_material(configuration), scene);
  } catch (const std::invalid_argument& error) {
    throw ParameterError(std::string("parameter 'material': ") + error.what());
  }
  continue_with(scene, configuration);
}

std::string LiveSimulation::parameter(const std::string& name) const {
  const auto object = grasp_parameter(name);
  if (!object) return parameter_text(simulation_->configuration(), name);
  const Scene& scene = simulation_->scene();
  return name_of(scene.bodies[graspable_body(name, *object, scene)].grasp);
}

void LiveSimulation::add(const Body& body) {
  Scene part;
  part.bodies.push_back(body);
  add(part);
}

void LiveSimulation::add(const Scene& part) {
  Scene scene = simulation_->scene();
  const std::size_t old = scene.bodies.size();
  append(part, scene);
  for (const Body& body : part.bodies) check_in_bounds(body.name, body.start.position, scene.bounds);
  auto next = std::make_unique<Simulation>(std::move(scene), simulation_->configuration());
  next->go_on_from(*simulation_);
  check_free_places(*next, old);
  simulation_ = std::move(next);
}

void LiveSimulation::remove(const std::string& name) {
  Scene scene = simulation_->scene();
  const std::size_t body = known_body(scene, name, false);
  if (scene.bodies[body].is_operator)
    throw std::invalid_argument("'" + name + "' is an operator, who cannot be deleted; allowed: objects");
  remove_body(body, scene);
  continue_with(scene, simulation_->configuration());
}

std::vector<Event> LiveSimulation::events_if_removed(const std::string& name) const {
  const Scene& scene = simulation_->scene();
  return events_if_left(hanging_on(known_body(scene, name, false), scene));
}

std::vector<Event> LiveSimulation::events_if_reset() const {
  std::vector<std::size_t> all(simulation_->scene().bodies.size());
  std::iota(all.begin(), all.end(), 0);
  return events_if_left(all);
}

std::vector<Event> LiveSimulation::events_if_left(const std::vector<std::size_t>& bodies) const {
  SimulationState state = simulation_->state();
  std::vector<Event> events;
  for (const std::size_t body : bodies)
    for (std::size_t slot = 0; slot < state.hands.size(); ++slot)
      end_interaction(
          {state.time, EventKind::hover_end, static_cast<int>(body), state.hands[slot].current.id},
          state.interactions[slot * state.bodies.size() + body], events);
  return events;
}

void LiveSimulation::place(const std::string& name, const Pose& pose) {
  const Scene& scene = simulation_->scene();
  const std::size_t body = known_body(scene, name, true);
  check_no_joint(scene, static_cast<int>(body));
  BodyState at_rest;
  at_rest.pose = checked_pose(name, pose, scene.bounds);
  SimulationState state = simulation_->state();
  mrhi::place(body, at_rest, state);
  if (scene.bodies[body].is_operator) mark_hands_appeared(state);
  simulation_->set_state(state);
}

void LiveSimulation::restrain(bool on) {
  const Scene& scene = simulation_->scene();
  SimulationState state = simulation_->state();
  bool any = false;
  for (std::size_t o = 0; o < scene.operators.size(); ++o) {
    const Operator& op = scene.operators[o];
    if (!op.restraint) continue;
    any = true;
    const auto place = [&](int body) { return state.bodies[body].pose.position; };
    const double distance = (place(op.body) - place(*op.restraint)).norm();
    if (on && distance > op.reach)
      throw std::invalid_argument("'" + scene.bodies[op.body].name + "' is " + text::number(distance) +
                                  " m from '" + scene.bodies[*op.restraint].name +
                                  "'; allowed: at most its reach of " + text::number(op.reach) + " m");
    state.restrained[o] = on;
  }
  if (!any)
    throw std::invalid_argument(
        "no operator has a restraint; allowed: scenes whose YAML names one, as "
        "'operator: {restraint: LINK}'");
  simulation_->set_state(state);
}

void LiveSimulation::reset() {
  const std::string overlaps = overlaps_at_start(simulation_->scene(), kSearchesOfSpawn);
  if (!overlaps.empty())
    throw std::invalid_argument("where they start, " + text::one_line(overlaps, 400) +
                                "; allowed: places that are free: delete what was spawned there");
  simulation_->reset();
  SimulationState state = simulation_->state();
  const std::vector<Body>& bodies = simulation_->scene().bodies;
  for (std::size_t i = 0; i < state.interactions.size(); ++i)
    state.interactions[i].shown_in = !bodies[i % bodies.size()].fixed;
  simulation_->set_state(state);
}

void LiveSimulation::continue_with(const Scene& scene, const Configuration& configuration) {
  auto next = std::make_unique<Simulation>(scene, configuration);
  next->go_on_from(*simulation_);
  if (!same_filter(configuration, simulation_->configuration())) {
    SimulationState state = next->state();
    change_filter(filter_of(simulation_->configuration()), state.last_frame, state.hands);
    next->set_state(state);
  }
  simulation_ = std::move(next);
}

}  // namespace mrhi
