#include "impact_solver.h"

#include <algorithm>
#include <cmath>

#include "impact.h"

namespace mrhi {
namespace {

constexpr std::size_t kPointCapacity = 64;        // capacity for one step; grows if needed
constexpr double kTimeTolerance = 1e-12;          // impacts closer in time are simultaneous [s]
constexpr std::size_t kMaxImpactsPerContact = 4;  // of an island in one step, on average; then springs act
/// Limit of relaxed points of an island, beyond which no further impact of the step is sought.
constexpr std::size_t kMaxWork = 1500;
/// Largest number of contacts between bodies of an island that is not large.
constexpr std::size_t kMaxSmallIslandLinks = 16;
/// Number of points that all sweeps of a large island's impact relax together, and the least number of
/// sweeps.
constexpr int kLargeIslandWork = 1500, kMinLargeIslandSweeps = 8;
/// Limit of unknowns times points times sweeps of an impact of linkages.
constexpr Eigen::Index kLinkageWork = 200'000;
/// Slowest approach that is an impact in a large island [m/s].
constexpr double kMinImpactSpeed = 1e-3;
/// Impulses diverge if their sum exceeds this multiple of the largest sum that the impacts can need. Each
/// point needs at most (1 + epsilon) m |u|, as n'Kn >= 1/m. Between fingers that close from opposite
/// directions each impulse drives the body into the other finger, and impulses grow from sweep to sweep.
constexpr double kDivergenceFactor = 4.0;

bool is_large(const Island& island) {
  return island.links.size() > kMaxSmallIslandLinks;
}

/// Returns the slowest approach that is an impact: kMinImpactSpeed plus the speed that gravity adds in a
/// step, h g [m/s].
double slow_in(const ContactStep& step) {
  return kMinImpactSpeed + step.step * step.gravity.norm();
}

ImpactPoint::Partner partner(ContactStep& step, std::size_t index, const Vector3& arm) {
  const Body& body = step.scene.bodies[index];
  ImpactPoint::Partner partner;
  if (body.fixed) return partner;
  partner.state = &step.bodies[index];
  partner.inverse_mass = 1.0 / body.mass;
  partner.body = &body;
  partner.orientation = partner.state->pose.orientation;
  partner.inverse_inertia = world_inverse_inertia(body, partner.orientation);
  partner.arm = arm;
  return partner;
}

/// Returns the radius of a body that is a ball centred on its centre of mass; 0 for others.
double radius_of_ball(const Body& body) {
  if (body.fixed || body.shapes.size() != 1 || !body.shapes[0].pose.position.isZero(0.0)) return 0.0;
  const Sphere* ball = std::get_if<Sphere>(&body.shapes[0].shape);
  return ball == nullptr ? 0.0 : ball->radius;
}

/// Returns the point of a contact between two bodies at the start of the step; n.(c_a' - c_b') < 0
/// approaches. A contact found by continuous detection has the gap at its pair's first touch.
ImpactPoint point_of(ContactStep& step, BodyContact& contact) {
  ImpactPoint point;
  point.a = partner(step, contact.key.a, contact.arm_a);
  point.b = partner(step, contact.key.b, contact.arm_b);
  point.normal = contact.normal;
  // Gravity accelerates free bodies alike.
  point.acceleration = point.a.state == nullptr ? -contact.normal.dot(step.gravity) : 0.0;
  point.gap = -contact.depth;
  point.between = &contact;
  point.total = &contact.impulse;
  point.struck = &contact.struck;
  point.radius_a = radius_of_ball(step.scene.bodies[contact.key.a]);
  point.radius_b = radius_of_ball(step.scene.bodies[contact.key.b]);
  if (point.is_of_balls()) {
    point.a.arm = step.bodies[contact.key.b].pose.position - step.bodies[contact.key.a].pose.position;
    point.b.arm.setZero();
    point.advance_to(0.0);
  } else if (contact.first_touch >= 0.0) {
    point.time = contact.first_touch;
    point.advance_to(0.0);
  }
  return point;
}

/// Sets the depth for the springs of a pair whose velocity an impact has changed within the step. At the
/// constant velocity that springs assume, it gives the actual gap at the end of the step.
///
///     d+ = d - h u = -gap(h)      so      d = h u - gap(h)
///
/// at the velocity u of the end. A late impact moves a body towards its neighbour for the rest of the step
/// only. With the depth at the start of the step, d - h u would be an overlap that does not exist.
void widen(ImpactPoint point, double step) {
  point.advance_to(step);
  BodyContact& contact = *point.between;
  point.normal = contact.normal;
  point.a.arm = contact.arm_a;
  point.b.arm = contact.arm_b;
  contact.depth = std::min(contact.depth, step * point.rate() - point.gap);
}

}  // namespace

ImpactSolver::ImpactSolver() {
  points_.reserve(kPointCapacity);
  impact_.reserve(kPointCapacity);
  times_.reserve(kPointCapacity);
  reported_.reserve(2 * kPointCapacity);
  laws_.reserve(kPointCapacity);
}

// A point separates if gap + h n.(c1' - c2') > 0, with c2' by the velocity that springs alone cause at the
// end of the step: backward Euler's gap.
template <typename VelocityOf>
void ImpactSolver::drop_separating(const ContactStep& step, VelocityOf velocity_of) {
  const auto separates = [&](const ImpactPoint& point) {
    const double rate = point.normal.dot(point.hand_velocity - velocity_of(point));
    return point.by_hand && point.gap + step.step * rate > 0.0;
  };
  points_.erase(std::remove_if(points_.begin(), points_.end(), separates), points_.end());
}

// Impacts by a hand are simultaneous, those between bodies sequential. Elastic bodies transmit momentum only
// if each impact starts from the result of the previous one. Newton's cradle, solved simultaneously, would
// return the first ball and move the others as one. Large islands are solved simultaneously to save time.
void ImpactSolver::resolve(ContactStep& step, const Islands& islands, ImpactFriction friction,
                           const SpringMotion& springs) {
  friction_ = friction;
  for (Contact& contact : step.contacts) contact.impulse.setZero();
  for (BodyContact& contact : step.body_contacts) contact.impulse.setZero();
  for (const Island& island : islands.all()) {
    collect(step, island);
    if (springs && by_hand_ && island.bodies.size() == 1 && has_persistent_hand_contact(step, island)) {
      const Twist carried = springs(island);
      drop_separating(step, [&carried](const ImpactPoint& point) -> Vector3 {
        return carried.linear + carried.angular.cross(point.b.arm);
      });
    }
    const bool large = is_large(island);
    limits_ = large ? kLargeIslandLimits : kSmallIslandLimits;
    work_ = 0;
    if (large) drop_slow(step);
    if (points_.empty()) continue;
    if (large) {
      const int sweeps = kLargeIslandWork / static_cast<int>(points_.size());
      limits_.max_sweeps = std::clamp(sweeps, kMinLargeIslandSweeps, kLargeIslandLimits.max_sweeps);
    }
    if (by_hand_ || large) {
      resolve_simultaneously(step);
    } else {
      resolve_sequentially(step, island);
    }
  }
}

// A held island is solved once before the impact, like a held body, to find the points that its springs carry
// away from the hand. Impulses of limits are reported last, as start_with() resets the joints' laws.
void ImpactSolver::resolve(ContactStep& step, const Island& island, ImpactFriction friction,
                           IslandProblem& problem, const std::vector<JointState>& joints) {
  friction_ = friction;
  limits_ = kSmallIslandLimits;
  problem_ = &problem;
  velocity_ = problem.start();
  collect_in_joints(step, island, joints);
  if (points_.empty()) return;
  const Eigen::Index sweep = velocity_.size() * static_cast<Eigen::Index>(points_.size());
  limits_.max_sweeps = static_cast<int>(std::min<Eigen::Index>(limits_.max_sweeps, kLinkageWork / sweep));
  if (has_persistent_hand_contact(step, island)) {
    problem.solve();
    drop_separating(step, [&problem](const ImpactPoint& point) -> Vector3 {
      return point.b.joints->jacobian * problem.joint_velocity();
    });
  }
  impact_.clear();
  for (ImpactPoint& point : points_) impact_.push_back(&point);
  // Newton's law has no solution for fingers from opposite directions; the springs act instead.
  if (!resolve_impact(step)) return;
  problem.start_with(velocity_, step, joints);
  for (const ImpactPoint& point : points_) {
    if (point.total != nullptr) continue;
    Eigen::Index unknown = 0;
    point.b.joints->jacobian.row(0).cwiseAbs().maxCoeff(&unknown);
    problem.note_limit_impulse(unknown, -point.normal_impulse * point.b.joints->jacobian(0, unknown));
  }
}

/// Collects contacts, and joints that reach a limit within the step as contacts along their coordinate.
/// Springs and gravity, which act through the step, then find the joint moving back, and add no further
/// energy.
///
///     w = hand_velocity - J u, with J of body 2 less that of body 1: w.n < 0 approaches (Eq. 8)
///     a limit:   room = upper - q for u > 0, q - lower for u < 0;   collides if 0 < room < h |u|
///                w = -sign u: < 0 approaches, as of surfaces; the impulse on the joint is -sign j
void ImpactSolver::collect_in_joints(ContactStep& step, const Island& island,
                                     const std::vector<JointState>& joints) {
  points_.clear();
  const auto add_point = [&](int number, const Vector3& arm, double sign) {
    const IslandProblem::Columns& of = problem_->columns_of(number);
    problem_->add_point_jacobian(number, arm, sign,
                                 coordinates_[points_.size()].jacobian.middleCols(of.first, of.count));
  };
  for (const IslandBody& body : island.bodies) {
    for (std::size_t i = body.first; i < body.last; ++i) {
      Contact& contact = step.contacts[i];
      if (contact.ignored || contact.struck) continue;
      ImpactPoint point = point_in_joints(contact.normal, -contact.depth);
      set_hand(contact, point);
      add_point(island.number_of(body.body), contact.point - step.bodies[body.body].pose.position, 1.0);
      Material material = step.scene.bodies[body.body].material;
      material.restitution = contact.restitution.value_or(material.restitution);
      if (add_in_joints(step.step, point, material)) contact.time_of_impact = points_.back().time;
    }
  }
  for (const IslandContact& link : island.links) {
    BodyContact& contact = step.body_contacts[link.index];
    if (contact.struck) continue;
    ImpactPoint point = point_in_joints(contact.normal, -contact.depth);
    point.between = &contact, point.total = &contact.impulse, point.struck = &contact.struck;
    add_point(island.number_of(contact.key.b), contact.arm_b, 1.0);
    if (!step.scene.bodies[contact.key.a].fixed)
      add_point(island.number_of(contact.key.a), contact.arm_a, -1.0);
    add_in_joints(step.step, point, contact.material);
  }
  for (const IslandProblem::Unknown& unknown : problem_->unknowns()) {
    if (unknown.joint == LinkageBody::kNone) continue;
    const Joint& joint = step.scene.joints[unknown.joint];
    const double sign = velocity_[unknown.row] > 0.0 ? 1.0 : -1.0;
    const double position = joints[unknown.joint].position;
    const double travel = sign > 0.0 ? joint.upper - position : position - joint.lower;
    if (joint.restitution <= 0.0 || travel <= 0.0) continue;
    const ImpactPoint point = point_in_joints(Vector3::UnitX(), travel);
    coordinates_[points_.size()].jacobian(0, unknown.row) = sign;
    Material smooth;
    smooth.restitution = joint.restitution;
    smooth.static_friction = 0.0;
    add_in_joints(step.step, point, smooth);
  }
}

/// Returns the next point and clears its Jacobian in `coordinates_`.
ImpactPoint ImpactSolver::point_in_joints(const Vector3& normal, double gap) {
  if (coordinates_.size() == points_.size()) coordinates_.emplace_back();
  JointCoordinates& coordinates = coordinates_[points_.size()];
  coordinates.jacobian.setZero(3, velocity_.size());
  coordinates.velocity = &velocity_;
  ImpactPoint point;
  point.b.joints = &coordinates;
  point.normal = normal;
  point.gap = gap;
  return point;
}

/// Adds the point if it collides within the step. The rate excludes gravity: the velocity is that at the
/// start of the step.
bool ImpactSolver::add_in_joints(double step, ImpactPoint point, const Material& material) {
  const double rate = point.rate();
  if (classify(rate) != Approach::colliding) return false;
  point.time = time_to_close(point.gap, rate, 0.0);
  if (point.between != nullptr) point.time += std::max(0.0, point.between->first_touch);
  if (point.time >= step) return false;
  JointCoordinates& coordinates = coordinates_[points_.size()];
  coordinates.response.resize(velocity_.size(), 3);
  for (int i = 0; i < 3; ++i) {
    column_ = coordinates.jacobian.row(i).transpose();
    problem_->solve_mass(column_);
    coordinates.response.col(i) = column_;
  }
  add(point, material);
  return true;
}

/// Sets a hand's part of a point: velocity, mass and recoil of the capsule.
void ImpactSolver::set_hand(Contact& contact, ImpactPoint& point) {
  point.by_hand = true;
  point.hand_velocity = contact.hand_velocity;
  point.a.inverse_mass = contact.inverse_mass + contact.carrier_inverse_mass;
  point.a.recoil = &recoils_[std::size_t(contact.key.hand) * kCapsules + contact.key.capsule];
  point.a.recoil->setZero();
  point.total = &contact.impulse;
  point.struck = &contact.struck;
}

void ImpactSolver::collect(ContactStep& step, const Island& island) {
  points_.clear();
  by_hand_ = false;
  for (const IslandBody& body : island.bodies) {
    for (std::size_t i = body.first; i < body.last; ++i) {
      Contact& contact = step.contacts[i];
      if (!contact.ignored && !contact.struck) add(step, contact);
    }
  }
  const bool large = is_large(island);
  if (large) note_twists(step, island);
  for (const IslandContact& link : island.links) {
    BodyContact& contact = step.body_contacts[link.index];
    if (contact.struck || (large && is_slow(step, contact))) continue;
    add(step, contact);
  }
}

void ImpactSolver::note_twists(const ContactStep& step, const Island& island) {
  twists_.resize(step.bodies.size());
  for (const IslandBody& body : island.bodies)
    twists_[body.body] = twist_of(step.scene.bodies[body.body], step.bodies[body.body]);
}

/// True if the approach is too slow for an impact in a large island.
bool ImpactSolver::is_slow(const ContactStep& step, const BodyContact& contact) const {
  const Body &a = step.scene.bodies[contact.key.a], &b = step.scene.bodies[contact.key.b];
  if (radius_of_ball(a) > 0.0 && radius_of_ball(b) > 0.0) return false;
  const Twist none, &of_a = a.fixed ? none : twists_[contact.key.a], &of_b = twists_[contact.key.b];
  const Vector3 velocity =
      of_a.linear + of_a.angular.cross(contact.arm_a) - of_b.linear - of_b.angular.cross(contact.arm_b);
  return contact.normal.dot(velocity) > -slow_in(step);
}

// A hand's points keep their velocity through the step. The object falls, which changes the gap by g t^2 / 2.
// A gap that closes after the end of the step is left to a later step.
void ImpactSolver::add(ContactStep& step, Contact& contact) {
  const Body& body = step.scene.bodies[contact.key.body];
  const BodyState& state = step.bodies[contact.key.body];
  const double rate = contact.normal.dot(relative_velocity(contact, body, state));
  if (classify(rate) != Approach::colliding) return;
  ImpactPoint point;
  point.acceleration = -contact.normal.dot(step.gravity);
  point.time = time_to_close(-contact.depth, rate, point.acceleration);
  if (point.time >= step.step) return;
  contact.time_of_impact = point.time;
  point.b = partner(step, contact.key.body, contact.point - state.pose.position);
  set_hand(contact, point);
  point.gap = -contact.depth;
  point.normal = contact.normal;
  by_hand_ = true;
  add(point, body.material);
  points_.back().restitution = contact.restitution.value_or(body.material.restitution);
}

void ImpactSolver::add(ContactStep& step, BodyContact& contact) {
  const ImpactPoint point = point_of(step, contact);
  if (point.collision_time() < step.step) {
    add(point, contact.material);
  } else if (point.is_of_balls() && point.gap > 0.0) {
    widen(point, step.step);  // they pass each other
  }
}

void ImpactSolver::add(ImpactPoint point, const Material& material) {
  point.restitution = material.restitution;
  if (friction_ == ImpactFriction::coulomb) point.friction = material.static_friction;
  points_.push_back(point);
}

void ImpactSolver::drop_slow(const ContactStep& step) {
  const double slow = slow_in(step);
  const auto is_slow = [slow](const ImpactPoint& point) { return !point.by_hand && point.rate() > -slow; };
  points_.erase(std::remove_if(points_.begin(), points_.end(), is_slow), points_.end());
}

// Points of a pair collide with the first of them: the gaps of the others, which the impact stops too, stay.
void ImpactSolver::resolve_simultaneously(ContactStep& step) {
  for (auto from = points_.begin(), to = from; from != points_.end(); from = to) {
    to = std::find_if(from, points_.end(), [from](const ImpactPoint& p) { return !p.same_pair(*from); });
    if (from->by_hand) continue;
    double first = step.step;
    std::for_each(from, to, [&](const ImpactPoint& p) { first = std::min(first, p.collision_time()); });
    std::for_each(from, to, [&](ImpactPoint& p) { p.advance_to(first); });
  }
  impact_.clear();
  for (ImpactPoint& point : points_) impact_.push_back(&point);
  resolve_impact(step);
}

// All links take part: an impact may make any of them approach. The number of impacts and the work are
// bounded, as the series may be infinite (Zeno: a ball that bounces to rest between two others within a
// step).
void ImpactSolver::resolve_sequentially(ContactStep& step, const Island& island) {
  points_.clear();
  for (const IslandContact& link : island.links) {
    BodyContact& contact = step.body_contacts[link.index];
    const ImpactPoint point = point_of(step, contact);
    const bool keeps_approaching = contact.struck && classify(point.rate()) == Approach::colliding;
    if (!keeps_approaching) add(point, contact.material);
  }
  for (std::size_t i = 0; i < kMaxImpactsPerContact * points_.size() && work_ < kMaxWork; ++i) {
    if (!find_next_impact(step.step) || !resolve_impact(step)) break;
  }
  for (const ImpactPoint& point : points_) widen(point, step.step);
}

/// Finds the next impact before `end`, and advances all points to it. An impact includes all points that
/// collide in this step of each pair with a point that collides now, at once: one after the other they would
/// tip a box that lands flat.
bool ImpactSolver::find_next_impact(double end) {
  times_.clear();
  for (const ImpactPoint& point : points_) times_.push_back(point.collision_time());
  const double first = *std::min_element(times_.begin(), times_.end());
  if (first >= end) return false;
  impact_.clear();
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const auto now = [&](std::size_t other) {
      return times_[other] <= first + kTimeTolerance && points_[i].same_pair(points_[other]);
    };
    bool in_impact = false;
    for (std::size_t other = 0; times_[i] < end && other < points_.size(); ++other)
      in_impact = in_impact || now(other);
    if (in_impact) impact_.push_back(&points_[i]);
    points_[i].advance_to(first);
  }
  for (ImpactPoint& point : points_) {
    const auto shares_body = [&point](const ImpactPoint* hit) { return hit->shares_body(point); };
    if (std::any_of(impact_.begin(), impact_.end(), shares_body)) point.turn_inertia();
  }
  return true;
}

/// Resolves the points of one impact. Returns false if no impulses without pull satisfy Newton's law.
bool ImpactSolver::resolve_impact(ContactStep& step) {
  double max_impulse = 0.0;  // upper bound of the sum of normal impulses for these approaches [N s]
  const auto separates = [&max_impulse](ImpactPoint* point) {
    point->begin();
    point->approach = point->velocity_on_impact();
    // Eqs. 10, 11 at the time of impact, u' = -epsilon u with u = rate + t a. In terms of the rate by the
    // momenta: rate' = u' - t a = rate - (1 + epsilon) u. So the step's gravity is neither lost nor applied
    // twice.
    point->target = point->rate();
    const double speed = point->target + point->time * point->acceleration;
    if (classify(speed) != Approach::colliding) return true;
    point->target -= (1.0 + point->restitution) * speed;
    max_impulse += -(1.0 + point->restitution) * speed * point->max_normal_mass();
    if (point->struck != nullptr) *point->struck = true;
    return false;
  };
  impact_.erase(std::remove_if(impact_.begin(), impact_.end(), separates), impact_.end());
  if (impact_.empty()) return true;
  if (solve(max_impulse)) {
    limit_energy(max_impulse);
    report(step);
    return true;
  }
  // Newton's law has no solution for fingers from opposite directions; the springs act instead.
  for (ImpactPoint* point : impact_) point->undo();
  return false;
}

/// Solves for impulses that together give every point its target rate; returns false if they diverge. The
/// error is the largest change of a velocity in a sweep, its scale the largest j n'Kn. Friction depends on j,
/// so each sweep relaxes the normal first, then friction.
bool ImpactSolver::solve(double max_impulse) {
  for (int sweep = 0; sweep < limits_.max_sweeps; ++sweep) {
    work_ += impact_.size();
    double error = 0.0, scale = 0.0, sum = 0.0;
    for (ImpactPoint* point : impact_) {
      error = std::max(error, point->relax());
      if (point->normal_mass > 0.0) scale = std::max(scale, point->normal_impulse / point->normal_mass);
      sum += point->normal_impulse;
    }
    if (error <= limits_.tolerance * scale) return true;
    if (sum > kDivergenceFactor * max_impulse) return false;
  }
  return true;
}

/// If restitution and friction together add energy, blends the impact with one without restitution. That
/// impact, u' = 0, starts from the same velocities: the impulses are undone, and the target is raised by
/// epsilon u.
void ImpactSolver::limit_energy(double max_impulse) {
  laws_.clear();
  double gain = 0.0, exchanged = 0.0;
  for (const ImpactPoint* point : impact_) {
    const Vector3 impulse = point->impulse(), after = point->velocity_on_impact();
    laws_.push_back({point->approach, impulse, after, {}, {}});
    gain += energy_gained(point->approach, impulse, after);
    exchanged += impulse.norm() * point->approach.norm();
  }
  if (gain <= kGainTolerance * exchanged) return;
  for (ImpactPoint* point : impact_) point->undo();
  for (ImpactPoint* point : impact_) {
    point->begin();
    point->target += point->restitution * point->normal.dot(point->approach);
  }
  solve(max_impulse);
  for (std::size_t i = 0; i < impact_.size(); ++i)
    laws_[i].plastic = impact_[i]->impulse(), laws_[i].after_plastic = impact_[i]->velocity_on_impact();
  keep_from_gaining(laws_);
  for (std::size_t i = 0; i < impact_.size(); ++i) impact_[i]->set_impulse(laws_[i].newtons);
}

// J and its time, for both bodies: the flight removes J's displacement before that time (StepChanges).
void ImpactSolver::report(ContactStep& step) {
  reported_.clear();
  const auto note = [&](const ImpactPoint& point, const ImpactPoint::Partner& partner,
                        const Vector3& impulse) {
    if (partner.state == nullptr) return;
    const auto body = static_cast<int>(partner.state - step.bodies.data());
    reported_.push_back({body, impulse, partner.arm, point.time});
  };
  for (const ImpactPoint* point : impact_) {
    if (point->total != nullptr) *point->total += point->impulse();
    note(*point, point->a, -point->impulse());
    note(*point, point->b, point->impulse());
  }
  step.changes.note_impacts(reported_, step.bodies);
}

}  // namespace mrhi
