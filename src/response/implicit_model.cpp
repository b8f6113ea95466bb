#include "implicit_model.h"

#include <algorithm>

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
  share_strength(configuration_.hand, step.contacts);
  if (configuration_.edge_grip) grip_edges(step);
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
    problem_.begin(step, island, configuration_);
    problem_.solve();
    return problem_.velocity();
  };
  impacts_.resolve(step, islands_, impact_friction(), springs);
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
  if (island.bodies.size() > 1) return solve_several(step, island);
  problem_.begin(step, island, configuration_);
  bool agree = problem_.solve();
  // The operator receives the contacts' forces, so the momenta must follow from these.
  const bool by_forces = step.operators != nullptr && !reacts_by_momentum(step, island.bodies.begin()->body);
  if (!agree && by_forces) {
    problem_.evaluate(true);  // at the final velocity
    agree = true;
  }
  const bool acts = problem_.scale() > 0.0;
  if (acts) problem_.finish(agree, step, island);
  return acts;
}

bool ImplicitModel::solve_several(ContactStep& step, const Island& island) {
  several_.begin(step, island, configuration_, last_forces_);
  several_.solve(step);
  const bool acts = several_.acts();
  if (acts) several_.finish(step, island);
  return acts;
}

/// The default stiffness is stable at any step and mass.
extern const ContactModelEntry implicit_model{
    "implicit", 0, 2000.0,
    [](const ContactConfiguration& configuration) -> std::unique_ptr<ContactModel> {
      return std::make_unique<ImplicitModel>(configuration);
    },
    true};

}  // namespace mrhi
