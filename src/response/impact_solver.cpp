#include "impact_solver.h"

#include <algorithm>
#include <cmath>

#include "mr_hand_interaction/collision/god_object.h"
#include "mr_hand_interaction/response/impact.h"

namespace mrhi {
namespace {

constexpr std::size_t kUsualStrikes = 64;  // in one step; for more memory grows
constexpr int kMaxSweeps = 500;
constexpr double kConverged = 1e-13;  // of the approach velocity
constexpr double kTogether = 1e-12;   // blows nearer to each other in time than this are one [s]
/// Impulses that grow beyond this multiple of what the blows need have no end.
constexpr double kPressed = 4.0;

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

/// Moves the arms on to where the two surfaces meet, at one point: so that the blow keeps angular momentum.
void meet(Strike& strike) {
  const Vector3 point = 0.5 * (strike.a.velocity() + strike.b.velocity());
  for (Strike::Partner* partner : {&strike.a, &strike.b}) {
    if (partner->state == nullptr) continue;
    partner->arm += strike.time * (point - partner->inverse_mass * partner->state->linear_momentum);
  }
}

/// Moves one impact towards its target, never pulling; returns by how much its velocity was off [m/s].
double relax_normal(Strike& strike) {
  const double velocity = strike.normal.dot(strike.relative_velocity());
  const double wanted = std::max(0.0, strike.magnitude + strike.mass * (strike.target - velocity));
  const double change = wanted - strike.magnitude;
  strike.magnitude = wanted;
  strike.a.push(change * strike.normal);
  strike.b.push(-change * strike.normal);
  return std::abs(change) / strike.mass;
}

/// Stops the sliding at one impact as far as Coulomb's law lets it; returns the change of the impulse over
/// the normal's effective mass [m/s].
double relax_tangential(Strike& strike) {
  if (strike.friction <= 0.0) return 0.0;
  const Eigen::Vector2d needed = strike.along_mass * (strike.along.transpose() * strike.relative_velocity());
  Vector3 wanted = strike.drag + strike.along * needed;
  const double most = strike.friction * strike.magnitude, length = wanted.norm();
  if (length > most) wanted *= most / length;
  const Vector3 change = wanted - strike.drag;
  strike.drag = wanted;
  strike.a.push(-change);
  strike.b.push(change);
  return change.norm() / strike.mass;
}

/// Finds impulses that together give every strike its velocity; false if there are none.
template <typename Strikes>
bool solve(Strikes first, Strikes last, double most) {
  for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
    double error = 0.0, scale = 0.0, sum = 0.0;
    for (auto strike = first; strike != last; ++strike) {
      error = std::max({error, relax_normal(*strike), relax_tangential(*strike)});
      scale = std::max(scale, strike->magnitude / strike->mass);
      sum += strike->magnitude;
    }
    if (error <= kConverged * scale) return true;
    if (sum > kPressed * most) return false;
  }
  return true;
}

/// An island of one body that a hand presses.
bool is_held(const ContactStep& step, const Island& island) {
  if (island.bodies.size() != 1) return false;
  const IslandBody& body = *island.bodies.begin();
  return std::any_of(step.contacts.begin() + static_cast<std::ptrdiff_t>(body.first),
                     step.contacts.begin() + static_cast<std::ptrdiff_t>(body.last),
                     [](const Contact& contact) { return contact.touching() && contact.struck; });
}

template <typename Strikes>
void undo(Strikes first, Strikes last) {
  for (auto strike = first; strike != last; ++strike) {
    const Vector3 impulse = strike->drag - strike->magnitude * strike->normal;
    strike->a.push(impulse);
    strike->b.push(-impulse);
  }
}

}  // namespace

Vector3 Strike::Partner::velocity() const {
  if (state == nullptr) return Vector3::Zero();
  return inverse_mass * state->linear_momentum + (inverse_inertia * state->angular_momentum).cross(arm);
}

void Strike::Partner::push(const Vector3& by) {
  if (state == nullptr) return;
  state->linear_momentum += by;
  state->angular_momentum += arm.cross(by);
}

Matrix3 Strike::Partner::inverse_effective_mass() const {
  if (state == nullptr) return Matrix3::Zero();
  return collision_matrix(inverse_mass, inverse_inertia, arm);
}

Vector3 Strike::relative_velocity() const {
  return drive + a.velocity() - b.velocity();
}

ImpactSolver::ImpactSolver() {
  strikes_.reserve(kUsualStrikes);
  impacts_.reserve(2 * kUsualStrikes);
}

void ImpactSolver::resolve(ContactStep& step, const Islands& islands, ImpactFriction friction,
                           const SpringMotion& springs) {
  for (Contact& contact : step.contacts) contact.impulse.setZero();
  for (BodyContact& contact : step.body_contacts) contact.impulse.setZero();
  for (const Island& island : islands.all()) {
    collect(step, island, friction);
    if (springs && by_hand_ && is_held(step, island)) spare_carried(step, springs(island));
    if (strikes_.empty()) continue;
    order_blows();
    for (auto blow = strikes_.begin(); blow != strikes_.end();) {
      const auto next = std::find_if(blow, strikes_.end(), [blow](const Strike& strike) {
        return strike.blow > blow->blow + kTogether;
      });
      deal(step, blow, next);
      blow = next;
    }
  }
}

void ImpactSolver::collect(ContactStep& step, const Island& island, ImpactFriction friction) {
  strikes_.clear();
  by_hand_ = false;
  for (const IslandBody& body : island.bodies) {
    for (std::size_t i = body.first; i < body.last; ++i) {
      Contact& contact = step.contacts[i];
      if (!contact.ignored && !contact.struck) add(step, contact, friction);
    }
  }
  for (const Link& link : island.links) {
    BodyContact& contact = step.body_contacts[link.index];
    if (!contact.struck) add(step, contact, friction);
  }
}

void ImpactSolver::add(ContactStep& step, Contact& contact, ImpactFriction friction) {
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
  strike.by_hand = true;
  strike.gap = -contact.depth;
  strike.drive = contact.hand_velocity;
  strike.normal = contact.normal;
  strike.impulse = &contact.impulse;
  strike.struck = &contact.struck;
  by_hand_ = true;
  add_strike(strike, body.material, friction);
}

void ImpactSolver::add(ContactStep& step, BodyContact& contact, ImpactFriction friction) {
  Strike strike;
  strike.a = partner(step, contact.key.a, contact.arm_a);
  strike.b = partner(step, contact.key.b, contact.arm_b);
  strike.drive.setZero();
  strike.normal = contact.normal;
  const double rate = contact.normal.dot(strike.relative_velocity());
  // Free bodies fall together.
  strike.acceleration = strike.a.state == nullptr ? -contact.normal.dot(step.gravity) : 0.0;
  strike.time = contact.first_touch;
  if (contact.first_touch < 0.0) {
    if (classify(rate) != Approach::colliding) return;
    strike.time = time_to_close(-contact.depth, rate, strike.acceleration);
  }
  if (strike.time >= step.step) return;
  if (contact.first_touch < 0.0) meet(strike);
  strike.impulse = &contact.impulse;
  strike.struck = &contact.struck;
  add_strike(strike, contact.material, friction);
}

void ImpactSolver::add_strike(Strike strike, const Material& material, ImpactFriction friction) {
  strike.order = strikes_.size();
  strike.restitution = material.restitution;
  const Matrix3 k = strike.a.inverse_effective_mass() + strike.b.inverse_effective_mass();
  strike.mass = 1.0 / strike.normal.dot(k * strike.normal);
  if (friction == ImpactFriction::coulomb) {
    strike.friction = material.static_friction;
    strike.along.col(0) = strike.normal.unitOrthogonal();
    strike.along.col(1) = strike.normal.cross(strike.along.col(0));
    strike.along_mass = (strike.along.transpose() * k * strike.along).inverse();
  }
  strikes_.push_back(strike);
}

void ImpactSolver::spare_carried(const ContactStep& step, const Twist& carried) {
  const auto parts = [&](const Strike& strike) {
    const Vector3 velocity = carried.linear + carried.angular.cross(strike.b.arm);
    const double rate = strike.normal.dot(strike.drive - velocity);
    return strike.by_hand && strike.gap + step.step * rate > 0.0;
  };
  strikes_.erase(std::remove_if(strikes_.begin(), strikes_.end(), parts), strikes_.end());
}

void ImpactSolver::order_blows() {
  if (by_hand_) return;  // all at once
  for (Strike& strike : strikes_) {
    strike.blow = strike.time;
    for (const Strike& other : strikes_) {
      const bool same_pair = other.a.state == strike.a.state && other.b.state == strike.b.state;
      if (same_pair) strike.blow = std::min(strike.blow, other.time);
    }
  }
  std::sort(strikes_.begin(), strikes_.end(), [](const Strike& x, const Strike& y) {
    return x.blow != y.blow ? x.blow < y.blow : x.order < y.order;
  });
}

/// One blow, from the velocities that the blows before it have left.
void ImpactSolver::deal(ContactStep& step, Strikes first, Strikes last) {
  double most = 0.0;  // of the magnitudes' sum that blows of these speeds can need [N s]
  for (auto strike = first; strike != last; ++strike) {
    strike->target = strike->normal.dot(strike->relative_velocity());
    const double speed = strike->target + strike->time * strike->acceleration;
    const bool meets = classify(speed) == Approach::colliding;
    if (meets) {
      strike->target -= (1.0 + strike->restitution) * speed;
      most += -(1.0 + strike->restitution) * speed / strike->b.inverse_mass;
    }
    *strike->struck = meets;
  }
  last = std::remove_if(first, last, [](const Strike& strike) { return !*strike.struck; });
  if (first == last) return;
  if (solve(first, last, most)) {
    report(step, first, last);
  } else {
    // Fingers that close from both sides press the body, they do not strike it: Newton's law has no
    // solution, and the springs take over.
    undo(first, last);
  }
}

void ImpactSolver::report(ContactStep& step, Strikes first, Strikes last) {
  impacts_.clear();
  const auto note = [&](const Strike& strike, const Strike::Partner& partner, const Vector3& impulse) {
    if (partner.state == nullptr) return;
    const auto body = static_cast<int>(partner.state - step.bodies.data());
    impacts_.push_back({body, impulse, partner.arm, strike.time});
  };
  for (auto strike = first; strike != last; ++strike) {
    *strike->impulse = strike->drag - strike->magnitude * strike->normal;
    note(*strike, strike->a, -*strike->impulse);
    note(*strike, strike->b, *strike->impulse);
  }
  step.changes.note_impacts(impacts_, step.bodies);
}

}  // namespace mrhi
