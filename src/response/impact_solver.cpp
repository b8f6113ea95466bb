#include "impact_solver.h"

#include <algorithm>
#include <cmath>

#include "../collision/god_object.h"
#include "impact.h"

namespace mrhi {
namespace {

constexpr std::size_t kUsualStrikes = 64;  // in one step; for more memory grows
constexpr double kTogether = 1e-12;        // blows nearer to each other in time than this are one [s]
constexpr std::size_t kBlowsEach = 4;  // of an island's contacts, on average, in one step; then springs act
/// Where so many strikes have been relaxed for an island, no more blows are looked for in this step.
constexpr std::size_t kMostWork = 1500;
/// An island of more contacts between bodies is a crowd.
constexpr std::size_t kFewLinks = 16;
/// A crowd's blow is swept through so often as comes to this many strikes relaxed, within limits.
constexpr int kCrowdWork = 1500, kLeastSweeps = 8;
/// Slower strikes are none in a crowd [m/s].
constexpr double kSlow = 1e-3;
bool is_crowd(const Island& island) {
  return island.links.size() > kFewLinks;
}

/// What gravity makes of things in a step counts as slow too [m/s].
/// slow = 1 mm/s + h g.
double slow_in(const ContactStep& step) {
  return kSlow + step.step * step.gravity.norm();
}

/// Impulses that grow beyond this multiple of what the blows need have no end.
/// The sum of what they need is at most (1 + epsilon) m |u| of each, as n'Kn >= 1/m. Between fingers that
/// close from both sides every impulse that turns the body from one is taken up by the other, and they grow
/// from sweep to sweep.
constexpr double kPressed = 4.0;

// Of a fixture 1/m and I^-1 are 0, which is what it is made with.
Strike::Partner partner(ContactStep& step, std::size_t index, const Vector3& arm) {
  const Body& body = step.scene.bodies[index];
  Strike::Partner partner;
  if (body.fixed) return partner;
  partner.state = &step.bodies[index];
  partner.inverse_mass = 1.0 / body.mass;
  partner.inverse_inertia = world_inverse_inertia(body, partner.state->pose.orientation);
  partner.arm = arm;
  return partner;
}

/// The radius of a body that is a ball about its centre of mass; 0 of others.
double radius_of_ball(const Body& body) {
  if (body.fixed || body.shapes.size() != 1 || !body.shapes[0].pose.position.isZero(0.0)) return 0.0;
  const Sphere* ball = std::get_if<Sphere>(&body.shapes[0].shape);
  return ball == nullptr ? 0.0 : ball->radius;
}

/// Of two bodies, as it is at the step's start.
/// n.(c_a' - c_b') < 0 approaches. A pair that is followed through the step (swept) comes with the time of
/// its first touch, and its gap is closed then.
Strike strike_of(ContactStep& step, BodyContact& contact) {
  Strike strike;
  strike.a = partner(step, contact.key.a, contact.arm_a);
  strike.b = partner(step, contact.key.b, contact.arm_b);
  strike.normal = contact.normal;
  // Free bodies fall together.
  strike.acceleration = strike.a.state == nullptr ? -contact.normal.dot(step.gravity) : 0.0;
  strike.gap = -contact.depth;
  strike.between = &contact;
  strike.impulse = &contact.impulse;
  strike.struck = &contact.struck;
  strike.radius_a = radius_of_ball(step.scene.bodies[contact.key.a]);
  strike.radius_b = radius_of_ball(step.scene.bodies[contact.key.b]);
  if (strike.is_of_balls()) {
    strike.a.arm = step.bodies[contact.key.b].pose.position - step.bodies[contact.key.a].pose.position;
    strike.b.arm.setZero();
    strike.move_to(0.0);
  } else if (contact.first_touch >= 0.0) {
    strike.gap = 0.0;
    strike.time = contact.first_touch;
    strike.move_to(0.0);
  }
  return strike;
}

/// An island of one body that a hand presses.
/// `struck` tells that it is not in its approach any more: a finger that is about to strike holds nothing
/// yet.
bool is_held(const ContactStep& step, const Island& island) {
  if (island.bodies.size() != 1) return false;
  const IslandBody& body = *island.bodies.begin();
  return std::any_of(step.contacts.begin() + static_cast<std::ptrdiff_t>(body.first),
                     step.contacts.begin() + static_cast<std::ptrdiff_t>(body.last),
                     [](const Contact& contact) { return contact.touching() && contact.struck; });
}

/// The springs look at where their ends are going from the step's start on: a gap that changes otherwise, by
/// a blow within the step, is for them what it would have had to be then to end up the same.
///
///     d+ = d - h u = -gap(h)      so      d = h u - gap(h)
///
/// at the end's velocity u. A blow late in the step sends a body at its neighbour for the rest of the step
/// only: with the depth that was found, d - h u would be an overlap that there is not.
void widen(Strike strike, double step) {
  strike.move_to(step);
  BodyContact& contact = *strike.between;
  strike.normal = contact.normal;
  strike.a.arm = contact.arm_a;
  strike.b.arm = contact.arm_b;
  contact.depth = std::min(contact.depth, step * strike.rate() - strike.gap);
}

}  // namespace

const ImpactSolver::Care ImpactSolver::kExact{500, 1e-13};
const ImpactSolver::Care ImpactSolver::kVisible{30, 1e-6};

ImpactSolver::ImpactSolver() {
  strikes_.reserve(kUsualStrikes);
  blow_.reserve(kUsualStrikes);
  meetings_.reserve(kUsualStrikes);
  impacts_.reserve(2 * kUsualStrikes);
  both_.reserve(kUsualStrikes);
}

// What a hand strikes is dealt at once, bodies among themselves in turn: elastic ones pass momentum on as
// they should only if each blow finds what the one before has left (of Newton's cradle dealt at once the
// first ball would bounce back and the others go on as one). A crowd has no time for that.
void ImpactSolver::resolve(ContactStep& step, const Islands& islands, ImpactFriction friction,
                           const SpringMotion& springs) {
  friction_ = friction;
  for (Contact& contact : step.contacts) contact.impulse.setZero();
  for (BodyContact& contact : step.body_contacts) contact.impulse.setZero();
  for (const Island& island : islands.all()) {
    collect(step, island);
    if (springs && by_hand_ && is_held(step, island)) spare_carried(step, springs(island));
    const bool crowd = is_crowd(island);
    care_ = crowd ? kVisible : kExact;
    work_ = 0;
    if (crowd) spare_slow(step);
    if (crowd && !strikes_.empty()) {
      const int often = kCrowdWork / static_cast<int>(strikes_.size());
      care_.sweeps = std::clamp(often, kLeastSweeps, kVisible.sweeps);
    }
    if (strikes_.empty()) continue;
    if (by_hand_ || crowd) {
      deal_at_once(step);
    } else {
      deal_in_turn(step, island);
    }
  }
}

void ImpactSolver::collect(ContactStep& step, const Island& island) {
  strikes_.clear();
  by_hand_ = false;
  for (const IslandBody& body : island.bodies) {
    for (std::size_t i = body.first; i < body.last; ++i) {
      Contact& contact = step.contacts[i];
      if (!contact.ignored && !contact.struck) add(step, contact);
    }
  }
  const bool crowd = is_crowd(island);
  if (crowd) note_twists(step, island);
  for (const Link& link : island.links) {
    BodyContact& contact = step.body_contacts[link.index];
    if (contact.struck || (crowd && is_slow(step, contact))) continue;
    add(step, contact);
  }
}

void ImpactSolver::note_twists(const ContactStep& step, const Island& island) {
  twists_.resize(step.bodies.size());
  for (const IslandBody& body : island.bodies)
    twists_[body.body] = twist_of(step.scene.bodies[body.body], step.bodies[body.body]);
}

/// Of a crowd: too slow to strike.
bool ImpactSolver::is_slow(const ContactStep& step, const BodyContact& contact) const {
  const Body &a = step.scene.bodies[contact.key.a], &b = step.scene.bodies[contact.key.b];
  if (radius_of_ball(a) > 0.0 && radius_of_ball(b) > 0.0) return false;
  const Twist none, &of_a = a.fixed ? none : twists_[contact.key.a], &of_b = twists_[contact.key.b];
  const Vector3 velocity =
      of_a.linear + of_a.angular.cross(contact.arm_a) - of_b.linear - of_b.angular.cross(contact.arm_b);
  return contact.normal.dot(velocity) > -slow_in(step);
}

// A hand's points go on as they do for the whole step; the object's fall with g, so that the gap closes by
// g t^2 / 2 more or less. What would close later than this step is left for its own.
void ImpactSolver::add(ContactStep& step, Contact& contact) {
  const Body& body = step.scene.bodies[contact.key.body];
  const BodyState& state = step.bodies[contact.key.body];
  const double rate = contact.normal.dot(relative_velocity(contact, body, state));
  if (classify(rate) != Approach::colliding) return;
  Strike strike;
  strike.acceleration = -contact.normal.dot(step.gravity);
  strike.time = time_to_close(-contact.depth, rate, strike.acceleration);
  if (strike.time >= step.step) return;
  contact.time_of_impact = strike.time;
  strike.b = partner(step, contact.key.body, contact.point - state.pose.position);
  strike.a.inverse_mass = contact.inverse_mass + contact.carrier_inverse_mass;
  strike.by_hand = true;
  strike.gap = -contact.depth;
  strike.drive = contact.hand_velocity;
  strike.normal = contact.normal;
  strike.impulse = &contact.impulse;
  strike.struck = &contact.struck;
  by_hand_ = true;
  add(strike, body.material);
  strikes_.back().restitution = contact.restitution.value_or(body.material.restitution);
}

void ImpactSolver::add(ContactStep& step, BodyContact& contact) {
  const Strike strike = strike_of(step, contact);
  if (strike.meeting() < step.step) {
    add(strike, contact.material);
  } else if (strike.is_of_balls() && strike.gap > 0.0) {
    widen(strike, step.step);  // they pass each other
  }
}

void ImpactSolver::add(Strike strike, const Material& material) {
  strike.restitution = material.restitution;
  if (friction_ == ImpactFriction::coulomb) strike.friction = material.static_friction;
  strikes_.push_back(strike);
}

// Parts is what has gap + h n.(c1' - c2') > 0, with c2' by the velocity that springs alone give the body at
// the step's end: backward Euler's gap, as the springs see it.
void ImpactSolver::spare_carried(const ContactStep& step, const Twist& carried) {
  const auto parts = [&](const Strike& strike) {
    const Vector3 velocity = carried.linear + carried.angular.cross(strike.b.arm);
    const double rate = strike.normal.dot(strike.drive - velocity);
    return strike.by_hand && strike.gap + step.step * rate > 0.0;
  };
  strikes_.erase(std::remove_if(strikes_.begin(), strikes_.end(), parts), strikes_.end());
}

void ImpactSolver::spare_slow(const ContactStep& step) {
  const double slow = slow_in(step);
  const auto is_slow = [slow](const Strike& strike) { return !strike.by_hand && strike.rate() > -slow; };
  strikes_.erase(std::remove_if(strikes_.begin(), strikes_.end(), is_slow), strikes_.end());
}

void ImpactSolver::deal_at_once(ContactStep& step) {
  blow_.clear();
  for (Strike& strike : strikes_) {
    if (!strike.by_hand) strike.move_to(strike.meeting());
    blow_.push_back(&strike);
  }
  deal(step);
}

// All links are looked at, also those that would not meet as they move now: a blow may send them to each
// other. Each sweep of the loop is one blow; that the series may be infinite (a ball that bounces to rest
// between two others within a step: Zeno) is why blows and work are bounded.
void ImpactSolver::deal_in_turn(ContactStep& step, const Island& island) {
  strikes_.clear();
  for (const Link& link : island.links) {
    BodyContact& contact = step.body_contacts[link.index];
    const Strike strike = strike_of(step, contact);
    const bool pressed = contact.struck && classify(strike.rate()) == Approach::colliding;
    if (!pressed) add(strike, contact.material);
  }
  for (std::size_t blows = 0; blows < kBlowsEach * strikes_.size() && work_ < kMostWork; ++blows) {
    if (!find_blow(step.step) || !deal(step)) break;
  }
  for (const Strike& strike : strikes_) widen(strike, step.step);
}

/// Finds the next blow before `end`, and moves all strikes on to it.
bool ImpactSolver::find_blow(double end) {
  meetings_.clear();
  for (const Strike& strike : strikes_) meetings_.push_back(strike.meeting());
  const double first = *std::min_element(meetings_.begin(), meetings_.end());
  if (first >= end) return false;
  blow_.clear();
  // One blow is all points, as far as they meet in this step, of each pair that has a point that meets now:
  // dealt one after the other they would tip a box that lands flat.
  for (std::size_t i = 0; i < strikes_.size(); ++i) {
    const auto now = [&](std::size_t other) {
      return meetings_[other] <= first + kTogether && strikes_[i].same_pair(strikes_[other]);
    };
    bool in_blow = false;
    for (std::size_t other = 0; meetings_[i] < end && other < strikes_.size(); ++other)
      in_blow = in_blow || now(other);
    if (in_blow) blow_.push_back(&strikes_[i]);
    strikes_[i].move_to(in_blow ? meetings_[i] : first);
  }
  return true;
}

/// One blow, from the velocities that the blows before it have left; false if there is none that only pushes.
bool ImpactSolver::deal(ContactStep& step) {
  double most = 0.0;  // of the magnitudes' sum that blows of these speeds can need [N s]
  const auto passes = [&most](Strike* strike) {
    strike->prepare();
    strike->approach = strike->velocity_on_impact();
    // Eqs. 10, 11 at the time of the blow, u' = -epsilon u with u = rate + t a, in terms of the rate, which
    // is the momenta's: rate' = u' - t a = rate - (1 + epsilon) u. That way gravity of the step is neither
    // lost nor given twice.
    strike->target = strike->rate();
    const double speed = strike->target + strike->time * strike->acceleration;
    if (classify(speed) != Approach::colliding) return true;
    strike->target -= (1.0 + strike->restitution) * speed;
    most += -(1.0 + strike->restitution) * speed / strike->b.inverse_mass;
    *strike->struck = true;
    return false;
  };
  blow_.erase(std::remove_if(blow_.begin(), blow_.end(), passes), blow_.end());
  if (blow_.empty()) return true;
  if (solve(most)) {
    keep_to_energy(most);
    report(step);
    return true;
  }
  // Fingers that close from both sides press the body, they do not strike it: Newton's law has no solution,
  // and the springs take over.
  for (Strike* strike : blow_) {
    strike->a.push(strike->given());
    strike->b.push(-strike->given());
  }
  return false;
}

/// Finds impulses that together give every strike its velocity; false if there are none.
/// In velocities: the error is the largest change of one in a sweep, its scale the largest j n'Kn. Friction
/// hangs on j, so both are relaxed in the same sweep, the normal first.
bool ImpactSolver::solve(double most) {
  for (int sweep = 0; sweep < care_.sweeps; ++sweep) {
    work_ += blow_.size();
    double error = 0.0, scale = 0.0, sum = 0.0;
    for (Strike* strike : blow_) {
      error = std::max({error, strike->relax_normal(), strike->relax_tangential()});
      scale = std::max(scale, strike->magnitude / strike->normal_mass);
      sum += strike->magnitude;
    }
    if (error <= care_.converged * scale) return true;
    if (sum > kPressed * most) return false;
  }
  return true;
}

/// Energy that the blow has given to the bodies beyond the work of the hands [J].
/// G = sum -J.(w + w') / 2, see energy_gained().
double ImpactSolver::gain() const {
  double sum = 0.0;
  for (const Strike* strike : blow_)
    sum += energy_gained(strike->approach, strike->given(), strike->velocity_on_impact());
  return sum;
}

/// Where restitution together with friction makes energy, the blow is one between theirs and one without
/// restitution.
/// The blow without restitution, u' = 0, is found from the same start: what has been given is taken back
/// first, and target is raised by epsilon u. Then the difference to the blend is given along n and across.
void ImpactSolver::keep_to_energy(double most) {
  double exchanged = 0.0;
  for (const Strike* strike : blow_) exchanged += strike->given().norm() * strike->approach.norm();
  if (gain() <= kNoGain * exchanged) return;
  both_.clear();
  for (const Strike* strike : blow_)
    both_.push_back({strike->approach, strike->given(), strike->velocity_on_impact(), {}, {}});
  for (Strike* strike : blow_) {
    strike->a.push(strike->given());
    strike->b.push(-strike->given());
  }
  for (Strike* strike : blow_) {
    strike->prepare();
    strike->target += strike->restitution * strike->normal.dot(strike->approach);
  }
  solve(most);
  for (std::size_t i = 0; i < blow_.size(); ++i)
    both_[i].least = blow_[i]->given(), both_[i].after_least = blow_[i]->velocity_on_impact();
  keep_from_gaining(both_);
  for (std::size_t i = 0; i < blow_.size(); ++i) {
    const Vector3 more = both_[i].newtons - blow_[i]->given();
    const double pressed = -blow_[i]->normal.dot(more);
    blow_[i]->magnitude += pressed;
    blow_[i]->drag += more + pressed * blow_[i]->normal;
    blow_[i]->a.push(-more);
    blow_[i]->b.push(more);
  }
}

// J and its time, on both: the flight takes back the way that J made before it fell (StepChanges).
void ImpactSolver::report(ContactStep& step) {
  impacts_.clear();
  const auto note = [&](const Strike& strike, const Strike::Partner& partner, const Vector3& impulse) {
    if (partner.state == nullptr) return;
    const auto body = static_cast<int>(partner.state - step.bodies.data());
    impacts_.push_back({body, impulse, partner.arm, strike.time});
  };
  for (const Strike* strike : blow_) {
    *strike->impulse += strike->given();
    note(*strike, strike->a, -strike->given());
    note(*strike, strike->b, strike->given());
  }
  step.changes.note_impacts(impacts_, step.bodies);
}

}  // namespace mrhi
