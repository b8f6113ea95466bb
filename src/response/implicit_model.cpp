#include "implicit_model.h"

#include <algorithm>
#include <cmath>

#include "finger_limits.h"

namespace mrhi {

// Eqs. 9 to 15 and then Eqs. 16 to 20, both at the end of the step. The order matters: impacts use the
// velocities at the start of the step, and springs those after the impacts.
void ImplicitModel::respond(ContactStep& step) {
  if (step.contacts.empty() && step.body_contacts.empty() && step.grips.empty()) return;
  begin_contacts(step);
  islands_.build(step);
  resolve_impacts(step);
  solve_islands(step);
  end_contacts(step);
}

// Limits that depend on the whole hand or on the last step's stretch are set first and held through the step.
// The solver of several bodies starts from the last step's forces.
void ImplicitModel::begin_contacts(ContactStep& step) {
  share_strength(step.configuration.hand, step.contacts);
  if (step.configuration.edge_grip) grip_edges(step);
  last_forces_.clear();
  for (BodyContact& contact : step.body_contacts) {
    last_forces_.push_back(contact.force);
    contact.force.setZero();
  }
  // Only contacts between bodies make islands of several.
  if (!last_forces_.empty())
    for (const Contact& contact : step.contacts) last_forces_.push_back(contact.force);
  for (Contact& contact : step.contacts) contact.force.setZero();
}

// A body that is held and hit is solved twice: before the impacts for the motion by its springs, and again
// after them. Without the first solution every phalanx beside an accelerating grip would hit the held object.
void ImplicitModel::resolve_impacts(ContactStep& step) {
  const auto springs = [&](const Island& island) {
    problem_.begin(step, island);
    problem_.solve();
    return problem_.velocity();
  };
  impacts_.resolve(step, islands_, impact_friction(step), springs);
}

/// The approach of a penetrating surface has ended, with or without an impact.
void ImplicitModel::end_contacts(ContactStep& step) {
  for (Contact& contact : step.contacts) contact.struck = contact.struck || contact.depth > 0.0;
  for (BodyContact& contact : step.body_contacts) contact.struck = contact.struck || contact.depth > 0.0;
}

// A solved body's momenta include h m g, so the flight must not apply gravity again. If nothing acts, the
// momenta stay and the flight applies gravity: this gives the exact parabola, where M v = p + h m g would be
// backward Euler's.
void ImplicitModel::solve_islands(ContactStep& step) {
  for (const Island& island : islands_.all()) {
    const bool acts = solve(step, island);
    for (const IslandBody& body : island.bodies) {
      if (acts) {
        step.changes.mark_solved(static_cast<int>(body.body));
      } else {
        step.bodies[body.body].pushed = Twist();
      }
    }
  }
}

/// Returns true if any force acts. Newton's method takes one body alone: where contacts between free bodies
/// opened and slipped, it did not converge in two steps of three.
bool ImplicitModel::solve(ContactStep& step, const Island& island) {
  if (island.bodies.size() > 1) {
    several_.begin(step, island, last_forces_);
    several_.solve(step);
    if (several_.acts()) several_.finish(step, island);
    return several_.acts();
  }
  problem_.begin(step, island);
  bool agree = problem_.solve();
  // The operator receives the contacts' forces, so the momenta must follow from these.
  const bool by_forces = step.operators != nullptr && !reacts_by_momentum(step, island.bodies.begin()->body);
  if (!agree && by_forces) {
    problem_.evaluate(true);  // at the final velocity
    agree = true;
  }
  if (problem_.scale() <= 0.0) return false;
  problem_.finish(agree, step, island);
  return true;
}

/// The default stiffness is stable at any step and mass.
extern const ContactModelEntry implicit_model{"implicit", 0, 2000.0, make_model<ImplicitModel>, true};

JointedModel::JointedModel(const Configuration& configuration, const Scene& scene, SimulationState& state,
                           std::vector<Event>& events)
    : scene_(scene),
      state_(state),
      events_(events),
      linkages_(linkages_of(scene)),
      awake_(linkages_.size()),
      solved_(linkages_.size()),
      regular_step_(configuration.step) {
  for (const Linkage& linkage : linkages_) {
    groups_.emplace_back();
    for (const LinkageBody& link : linkage.bodies) groups_.back().push_back(link.body);
    motions_.emplace_back(scene, linkage);
    flights_.emplace_back(scene, linkage);
  }
}

// As ImplicitModel's, with islands that have joints in joint coordinates. Then linkages are advanced:
// free_flight() skips their bodies.
void JointedModel::respond(ContactStep& step) {
  begin_contacts(step);
  islands_.build(step, groups_);
  ImplicitModel::resolve_impacts(step);
  solve_islands(step);
  std::fill(awake_.begin(), awake_.end(), char(0));
  std::fill(solved_.begin(), solved_.end(), char(0));
  for (const Island& island : islands_.with_joints()) {
    if (!state_.asleep[island.bodies.first->body]) respond(step, island);
  }
  end_contacts(step);
  fly(step);
}

/// Places a linkage by its joint positions, and computes its mass matrix.
void JointedModel::place(const ContactStep& step, std::size_t index) {
  const Linkage& linkage = linkages_[index];
  positions_.resize(linkage.joints());
  int joint = 0;
  for (const LinkageBody& link : linkage.bodies) {
    if (link.joint != LinkageBody::kNone) positions_[joint++] = state_.joints[link.joint].position;
  }
  motions_[index].place(step.bodies[groups_[index].front()].pose, positions_);
  motions_[index].weigh();
}

// If nothing acts, the island is left to the flight, which has gravity and no forces. This is exact to the
// flight's order, and free motion is not damped by a backward Euler step.
void JointedModel::respond(ContactStep& step, const Island& island) {
  for (std::size_t i = 0; i < linkages_.size(); ++i) {
    if (!island.contains(groups_[i].front())) continue;
    awake_[i] = 1;
    place(step, i);
  }
  problem_.begin(step, island, linkages_, motions_, state_.joints, regular_step_);
  impacts_.resolve(step, island, impact_friction(step), problem_, state_.joints);
  if (!problem_.acts()) return;
  bool agree = problem_.solve();
  if (!agree && step.operators == nullptr) problem_.keep_to_energy(step, island);
  if (!agree && step.operators != nullptr) {
    problem_.evaluate(true);  // at the final velocity
    agree = true;
  }
  problem_.finish(agree, step, island, state_.joints);
  for (std::size_t i = 0; i < linkages_.size(); ++i) {
    if (island.contains(groups_[i].front())) solved_[i] = 1;
  }
}

void JointedModel::fly(const ContactStep& step) {
  for (std::size_t i = 0; i < linkages_.size(); ++i) {
    if (!awake_[i]) continue;
    // If the island was solved, its momenta already include gravity.
    flights_[i].fly(solved_[i] ? Vector3(Vector3::Zero()) : step.gravity, step.step, state_.joints,
                    step.bodies);
    for (const LinkageBody& link : linkages_[i].bodies) {
      step.changes.forget(link.body);
      if (link.joint != LinkageBody::kNone) note(link.joint);
    }
  }
}

void JointedModel::note(std::size_t index) {
  const JointChange change = note_place(scene_.joints[index], state_.joints[index]);
  const auto report = [&](bool happened, EventKind kind) {
    if (happened) events_.push_back({state_.time, kind, scene_.joints[index].child, 0});
  };
  report(change.reached_limit, EventKind::joint_limit);
  report(change.entered_detent, EventKind::detent);
  report(change.opened_latch, EventKind::latch_open);
}

}  // namespace mrhi
