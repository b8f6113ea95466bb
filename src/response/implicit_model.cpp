#include "implicit_model.h"

#include <algorithm>

#include "finger_limits.h"
#include "newton.h"
#include "operator_reaction.h"

namespace mrhi {
namespace {

/// Islands of more bodies are crowds (where contacts opened and slipped Newton's method came to no end in
/// three steps of four: after 20 directions and 100 evaluations velocities were off by a quarter to all of
/// what contacts make of them),
constexpr std::size_t kMostExact = 4;
/// unless they hardly move, as those of a pile that stands: Newton's method begins at its end there.
constexpr std::size_t kMostAtRest = 10;

/// True if no body is faster than what falls for a step, so that nothing is about to strike.
/// |p| < m h g. At 0 g nothing is slower than that: columns in microgravity are crowds.
bool strikes_nothing(const ContactStep& step, const Island& island) {
  const double slow = step.step * step.gravity.norm();
  return std::all_of(island.bodies.begin(), island.bodies.end(), [&](const IslandBody& body) {
    return step.bodies[body.body].linear_momentum.norm() < slow * step.scene.bodies[body.body].mass;
  });
}

}  // namespace

// Eqs. 9 to 15 and then Eqs. 16 to 20, both at the step's end. The order matters: blows are dealt by the
// velocities of the step's start, and the springs find what the blows have left.
void ImplicitModel::respond(ContactStep& step) {
  if (step.contacts.empty() && step.body_contacts.empty() && step.grips.empty()) return;
  begin_touches(step);
  islands_.build(step);
  strike(step);
  press(step);
}

// Limits that hang on the whole hand or on the way of the step before are set first and held through the
// step.
void ImplicitModel::begin_touches(ContactStep& step) const {
  share_strength(configuration_.hand, step.contacts);
  if (configuration_.edge_grip) grip_edges(step);
}

// A body that is held and struck is solved twice: once for where its springs take it, and again after the
// blows. Without the first solution every phalanx beside a grip that speeds up would strike what it holds.
void ImplicitModel::strike(ContactStep& step) {
  // What springs alone would make of the island: the solver spares strikes that they carry away first.
  const auto springs = [&](const Island& island) {
    one_.begin(step, island, configuration_);
    Newton<BodyProblem>(one_).solve();
    return one_.velocity();
  };
  impacts_.resolve(step, islands_,
                   configuration_.impact_friction ? ImpactFriction::coulomb : ImpactFriction::none, springs);
}

void ImplicitModel::press(ContactStep& step) {
  // A phalanx or body that is inside has had its approach, impact or not.
  for (Contact& contact : step.contacts) {
    contact.force.setZero();
    contact.struck = contact.struck || contact.depth > 0.0;
  }
  // A contact's force of the last step is the crowd's first guess, taken down before it is cleared.
  carried_.clear();
  for (BodyContact& contact : step.body_contacts) {
    carried_.push_back(contact.force);
    contact.force.setZero();
    contact.struck = contact.struck || contact.depth > 0.0;
  }
  // M (u - u*) = h J' f(u): six unknowns with four contacts at a time, a few bodies to rounding, or a crowd.
  for (const Island& island : islands_.all()) {
    if (island.bodies.size() == 1) {
      solve_one(step, island);
    } else if (island.bodies.size() <= kMostExact ||
               (island.bodies.size() <= kMostAtRest && strikes_nothing(step, island))) {
      solve_few(step, island);
    } else {
      solve_crowd(step, island);
    }
  }
}

// Where nothing pressed, scale = h sum (N + bond) = 0, the body's momenta are left as they were, and the
// flight has gravity to give: the parabola is exact, where M v = p + h m g here would be backward Euler's.
void ImplicitModel::solve_one(ContactStep& step, const Island& island) {
  one_.begin(step, island, configuration_);
  bool agree = Newton<BodyProblem>(one_).solve();
  // Where contacts' forces are what an operator receives, they are to make the momenta.
  if (!agree && step.operators != nullptr && !reacts_by_momentum(step, island.bodies.begin()->body)) {
    one_.evaluate(true);  // it has moved on since
    agree = true;
  }
  const bool pressed = one_.scale() > 0.0;
  if (pressed) one_.finish(agree, step, island);
  note(step, island, pressed);
}

/// To rounding; where contacts keep opening and slipping by turns, as far as a crowd is.
void ImplicitModel::solve_few(ContactStep& step, const Island& island) {
  several_.begin(step, island, configuration_);
  if (!Newton<IslandProblem>(several_).solve()) {
    several_.evaluate(true);  // it has moved on since
    if (!several_.nearly_agree()) return solve_crowd(step, island);
  }
  const bool pressed = several_.scale() > 0.0;
  if (pressed) several_.finish(step, island);
  note(step, island, pressed);
}

void ImplicitModel::solve_crowd(ContactStep& step, const Island& island) {
  many_.begin(step, island, configuration_, carried_);
  many_.solve(step);
  const bool pressed = many_.pressed();
  if (pressed) many_.finish(step, island);
  note(step, island, pressed);
}

// Solved means that h m g is in the momenta already, so that the flight must not give it again.
void ImplicitModel::note(ContactStep& step, const Island& island, bool pressed) {
  for (const IslandBody& body : island.bodies) {
    if (pressed) {
      step.changes.mark_solved(static_cast<int>(body.body));
    } else {
      step.bodies[body.body].pushed = Twist();
    }
  }
}

/// Stable with that stiffness at any step and mass.
extern const ContactModelEntry implicit_model{
    "implicit", 0, 2000.0,
    [](const ContactConfiguration& configuration) -> std::unique_ptr<ContactModel> {
      return std::make_unique<ImplicitModel>(configuration);
    },
    true};

}  // namespace mrhi
