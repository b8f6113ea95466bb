#include "implicit_model.h"

#include <algorithm>

#include "finger_limits.h"
#include "operator_reaction.h"

namespace mrhi {
namespace {

/// Islands of more bodies are large (where contacts opened and slipped Newton's method did not converge in
/// three steps of four: after 20 directions and 100 evaluations velocities were off by a quarter to all of
/// what contacts make of them),
constexpr std::size_t kMaxExact = 4;
/// unless they hardly move, as those of a pile that stands: Newton's method begins at its solution there.
constexpr std::size_t kMaxAtRest = 10;

/// True if no body is faster than a fall of one step.
/// |p| < m h g. At 0 g nothing is slower than that: columns in microgravity are large islands.
bool is_nearly_at_rest(const ContactStep& step, const Island& island) {
  const double slow = step.step * step.gravity.norm();
  return std::all_of(island.bodies.begin(), island.bodies.end(), [&](const IslandBody& body) {
    return step.bodies[body.body].linear_momentum.norm() < slow * step.scene.bodies[body.body].mass;
  });
}

}  // namespace

// Eqs. 9 to 15 and then Eqs. 16 to 20, both at the step's end. The order matters: impacts are resolved by the
// velocities of the step's start, and the springs find what the impacts have left.
void ImplicitModel::respond(ContactStep& step) {
  if (step.contacts.empty() && step.body_contacts.empty() && step.grips.empty()) return;
  begin_contacts(step);
  islands_.build(step);
  resolve_impacts(step);
  solve_islands(step);
  end_contacts(step);
}

// Limits that depend on the whole hand or on the stretch of the step before are set first and held through
// the step. The large-island solver starts from the last step's forces.
void ImplicitModel::begin_contacts(ContactStep& step) {
  share_strength(configuration_.hand, step.contacts);
  if (configuration_.edge_grip) grip_edges(step);
  for (Contact& contact : step.contacts) contact.force.setZero();
  last_forces_.clear();
  for (BodyContact& contact : step.body_contacts) {
    last_forces_.push_back(contact.force);
    contact.force.setZero();
  }
}

// A body that is held and hit is solved twice: once for where its springs take it, and again after the
// impacts. Without the first solution every phalanx beside a grip that speeds up would hit what it holds.
void ImplicitModel::resolve_impacts(ContactStep& step) {
  const auto springs = [&](const Island& island) {
    problem_.begin(step, island, configuration_);
    problem_.solve();
    return problem_.velocity();
  };
  impacts_.resolve(step, islands_,
                   configuration_.impact_friction ? ImpactFriction::coulomb : ImpactFriction::none, springs);
}

/// A surface that is inside has had its approach, impact or not.
void ImplicitModel::end_contacts(ContactStep& step) {
  for (Contact& contact : step.contacts) contact.struck = contact.struck || contact.depth > 0.0;
  for (BodyContact& contact : step.body_contacts) contact.struck = contact.struck || contact.depth > 0.0;
}

// Solved means that h m g is in the momenta already, so that the flight must not give it again. Where nothing
// acts the momenta stay as they were, and the flight has gravity to give: the parabola is exact, where
// M v = p + h m g would be backward Euler's.
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

/// Returns true if any force acts. Islands whose contacts keep opening and slipping in turns go to the
/// large-island solver.
bool ImplicitModel::solve(ContactStep& step, const Island& island) {
  const std::size_t bodies = island.bodies.size();
  if (bodies > kMaxExact && (bodies > kMaxAtRest || !is_nearly_at_rest(step, island)))
    return solve_large(step, island);
  problem_.begin(step, island, configuration_);
  bool agree = problem_.solve();
  // The operator receives the contacts' forces: these must make the momenta.
  const bool by_forces = step.operators != nullptr && !reacts_by_momentum(step, island.bodies.begin()->body);
  if (!agree && (bodies > 1 || by_forces)) {
    problem_.evaluate(true);  // the velocity has moved on since
    if (bodies > 1 && !problem_.nearly_agrees()) return solve_large(step, island);
    agree = true;
  }
  const bool acts = problem_.scale() > 0.0;
  if (acts) problem_.finish(agree, step, island);
  return acts;
}

bool ImplicitModel::solve_large(ContactStep& step, const Island& island) {
  large_.begin(step, island, configuration_, last_forces_);
  large_.solve(step);
  const bool acts = large_.acts();
  if (acts) large_.finish(step, island);
  return acts;
}

/// Stable with that stiffness at any step and mass.
extern const ContactModelEntry implicit_model{
    "implicit", 0, 2000.0,
    [](const ContactConfiguration& configuration) -> std::unique_ptr<ContactModel> {
      return std::make_unique<ImplicitModel>(configuration);
    },
    true};

}  // namespace mrhi
