#include "linkage_problem.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

/// Of the momentum carried, what is rounding: an error below that times Effort::converged is none.
constexpr double kRounding = 1e-6;
/// Where less than this is missing, momenta are what the forces make of them; of the forces' impulse.
constexpr double kNearlyAgree = 1e-4;

/// Where more than this is missing, forces are no guess for the next step; of the forces' impulse.
constexpr double kFarOff = 0.01;
/// Springs give nothing to what parts faster [m/s].
constexpr double kReleaseSpeed = 0.1;

/// Islands of more bodies are many.
constexpr int kFewBodies = 4;

constexpr int kNoJoint = -1;

}  // namespace

// u0 = M^-1 sum J_b' p_b: momenta of the bodies as the joints see them. What of them joints do not let
// through is no error of this step: joints hold it back. u* = u0 + h M^-1 J' m g.
// Joints in their own coordinates and not by multipliers: no constraint is there that could drift and be
// drawn back (Baumgarte 1972), and M = J' M_b J is positive definite. J and M are those of the step's
// start; that axes turn meanwhile is the flight's (linkage_flight.h).
void LinkageProblem::begin(ContactStep& step, const Island& island, const ContactConfiguration& configuration,
                           const std::vector<Linkage>& linkages, std::vector<LinkageMotion>& motions,
                           const std::vector<JointState>& joints) {
  step_ = step.step;
  scene_ = &step.scene;
  acts_ = is_touched(step, island);
  several_.begin(step, island, configuration);
  number(step, island, linkages, motions);
  mass_factors_.compute(mass_);
  carried_ = std::sqrt(gradient_.squaredNorm());
  start_ = gradient_;
  solve_mass(start_);
  solve_mass(fall_);
  start_with(start_, step, joints);
}

void LinkageProblem::number(const ContactStep& step, const Island& island,
                            const std::vector<Linkage>& linkages, std::vector<LinkageMotion>& motions) {
  int count = 0;
  for (const Linkage& linkage : linkages) {
    if (island.place_of(linkage.bodies.front().body) >= 0) count += linkage.unknowns();
  }
  for (const IslandBody& body : island.bodies) count += step.scene.bodies[body.body].flies ? 6 : 0;
  const auto rows = static_cast<Eigen::Index>(6 * island.bodies.size());
  jacobian_.setZero(rows, count);
  mass_.setZero(count, count);
  for (Vector* vector : {&gradient_, &fall_}) vector->setZero(count);
  unknowns_.clear();
  for (std::size_t i = 0; i < linkages.size(); ++i) {
    if (island.place_of(linkages[i].bodies.front().body) >= 0)
      add_linkage(step, island, linkages[i], motions[i]);
  }
  for (const IslandBody& body : island.bodies) {
    if (step.scene.bodies[body.body].flies) add_free(step, island, body.body);
  }
}

/// The momenta at the step's start are gathered in the gradient, those of gravity in the fall.
/// A joint's torque is made a force by k^2 = M_ii / m of the body that hangs on it; of one that slides that
/// has no unit, and is how many times that body it moves.
void LinkageProblem::add_linkage(const ContactStep& step, const Island& island, const Linkage& linkage,
                                 LinkageMotion& motion) {
  const auto first = static_cast<Eigen::Index>(unknowns_.size());
  const Eigen::Index count = linkage.unknowns();
  mass_.block(first, first, count, count) = motion.mass();
  auto momenta = gradient_.segment(first, count), fall = fall_.segment(first, count);
  for (int i = 0; i < motion.size(); ++i) {
    const LinkageBody& link = linkage.bodies[static_cast<std::size_t>(i)];
    const Body& body = motion.body(i);
    const BodyState& state = step.bodies[static_cast<std::size_t>(link.body)];
    motion.push(i, state.linear_momentum, state.angular_momentum, momenta);
    motion.push(i, (step_ * body.mass) * step.gravity, Vector3::Zero(), fall);
    motion.add_jacobian(i, jacobian_.block(6 * island.place_of(link.body), first, 6, count));
    if (link.joint == LinkageBody::kNone) {
      for (int k = 0; k < 6; ++k)
        unknowns_.push_back({kNoJoint, link.body, k < 3 ? 1.0 : body.inertia.trace() / (3.0 * body.mass)});
    } else {
      const Eigen::Index column = first + linkage.column(i);
      unknowns_.push_back({link.joint, link.body, mass_(column, column) / body.mass});
    }
  }
}

void LinkageProblem::add_free(const ContactStep& step, const Island& island, std::size_t index) {
  const auto first = static_cast<Eigen::Index>(unknowns_.size());
  const Body& body = step.scene.bodies[index];
  const BodyState& state = step.bodies[index];
  const Matrix3 rotation = state.pose.orientation.toRotationMatrix();
  jacobian_.block<6, 6>(6 * island.place_of(static_cast<int>(index)), first).setIdentity();
  mass_.block<3, 3>(first, first).diagonal().setConstant(body.mass);
  mass_.block<3, 3>(first + 3, first + 3) = rotation * body.inertia * rotation.transpose();
  gradient_.segment<6>(first) << state.linear_momentum, state.angular_momentum;
  fall_.segment<3>(first) = (step_ * body.mass) * step.gravity;
  for (int k = 0; k < 6; ++k) {
    const double gyration_squared = body.inertia.trace() / (3.0 * body.mass);
    unknowns_.push_back({kNoJoint, static_cast<int>(index), k < 3 ? 1.0 : gyration_squared});
  }
}

// Free bodies have six unknowns each, so the second loop goes by sixes over those.
void LinkageProblem::start_with(const Vector& velocity, const ContactStep& step,
                                const std::vector<JointState>& joints) {
  start_ = velocity;  // which it may be itself
  free_ = start_ + fall_;
  velocity_ = free_;
  direction_.resize(start_.size());
  laws_.resize(unknowns_.size());
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (unknowns_[i].joint == kNoJoint) continue;
    const auto joint = static_cast<std::size_t>(unknowns_[i].joint);
    laws_[i].begin(scene_->joints[joint], joints[joint], mass_(row, row), step_, usual_);
    acts_ = acts_ || laws_[i].acts(std::max(std::abs(start_[row]), std::abs(free_[row])));
    velocity_[row] += step_ * joints[joint].pushed;
  }
  for (std::size_t i = 0; i < unknowns_.size(); i += unknowns_[i].joint == kNoJoint ? 6 : 1) {
    if (unknowns_[i].joint != kNoJoint) continue;
    const Twist& pushed = step.bodies[static_cast<std::size_t>(unknowns_[i].body)].pushed;
    velocity_.segment<3>(static_cast<Eigen::Index>(i)) += step_ * pushed.linear;
    velocity_.segment<3>(static_cast<Eigen::Index>(i) + 3) += step_ * pushed.angular;
  }
  body_start_.noalias() = jacobian_ * start_;
  body_free_.noalias() = jacobian_ * free_;
  several_.start_from(body_start_, body_free_);
}

/// M (u - u*) - h J' f(J u) - h t(u), with t what joints give by themselves: the impulses that are missing.
///
///     g = J' (M_b (J u - J u*) - h sum J_c' f) - h t(u),      J' M_b J = M: the bracket is IslandProblem's
///
/// scale: what contacts push and joints bear, each as a force, and a little of what is carried: where
/// nothing acts no part of nothing could be reached.
void LinkageProblem::evaluate(bool renew_limits) {
  body_velocity_.noalias() = jacobian_ * velocity_;
  several_.set_velocity(body_velocity_);
  several_.evaluate(renew_limits);
  gradient_.noalias() = jacobian_.transpose() * several_.gradient();
  scale_ = several_.scale() + kRounding * carried_;
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    if (unknowns_[i].joint == kNoJoint) continue;
    const double velocity = velocity_[static_cast<Eigen::Index>(i)];
    gradient_[static_cast<Eigen::Index>(i)] -= step_ * laws_[i].force(velocity);
    scale_ += step_ * laws_[i].size(velocity) / std::sqrt(unknowns_[i].gyration_squared);
  }
}

/// In N s: a torque about a joint counts as the force at the radius of gyration of what it carries.
double LinkageProblem::error_squared() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    const double missing = gradient_[static_cast<Eigen::Index>(i)];
    sum += missing * missing / unknowns_[i].gyration_squared;
  }
  return sum;
}

Effort LinkageProblem::effort() const {
  Effort effort;
  effort.limits = 2;
  effort.held_iterations = 20;
  if (body_start_.size() <= 6 * kFewBodies) return effort;
  effort.iterations = 12;
  effort.limits = 1;
  effort.held_iterations = 16;
  effort.unchecked = 0;
  effort.trials = 10;
  effort.converged = 1e-6;
  effort.anew = false;
  return effort;
}

/// H = J' (M_b + h K) J - h dt/du, dense: linkages are small, and J couples all of one.
/// -dt/du is not negative and each joint's own, on the diagonal.
void LinkageProblem::factorise() {
  several_.multiply_hessian(jacobian_, product_);
  hessian_.noalias() = jacobian_.transpose() * product_;
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(i);
    if (unknowns_[i].joint != kNoJoint) hessian_(row, row) += step_ * laws_[i].slope(velocity_[row]);
  }
  factors_.compute(hessian_);
}

void LinkageProblem::find_direction() {
  direction_ = -gradient_;
  factors_.solveInPlace(direction_);
}

/// That of IslandProblem::energy(), in the joints' coordinates, and what their own forces store: convex too,
/// as J is constant within the step and each joint's force falls as its velocity grows.
///
///     E(u) = E_b(J u) + h sum e_i(u_i),      de_i/du = -t_i
double LinkageProblem::energy() const {
  double sum = several_.energy();
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    if (unknowns_[i].joint != kNoJoint)
      sum += step_ * laws_[i].energy(velocity_[static_cast<Eigen::Index>(i)]);
  }
  return sum;
}

/// Contacts take energy, and give no more than their release speed has; hands give their own speed. A joint's
/// springs act on as they were, for what they store is small beside it: where Newton's method has failed a
/// linkage is in violent motion.
void LinkageProblem::keep_to_energy(const ContactStep& step, const Island& island) {
  double fastest = kReleaseSpeed, mass = 0.0;
  for (const IslandBody& body : island.bodies) {
    mass += step.scene.bodies[body.body].mass;
    for (std::size_t i = body.first; i < body.last; ++i)
      fastest = std::max(fastest, step.contacts[i].hand_velocity.norm());
  }
  const double allowed =
      std::max(kinetic_energy(start_), kinetic_energy(free_)) + 0.5 * mass * fastest * fastest;
  const double found = kinetic_energy(velocity_);
  if (found <= allowed) return;
  velocity_ = std::isfinite(found) ? Vector(std::sqrt(allowed / found) * velocity_) : start_;
  evaluate(true);
}

// Bodies get M_b J u: what joints do not let through of contacts' impulses, the joints hold, and it does
// not enter momenta at all. So J' of the bodies' momenta is M u, which the flight goes on from.
void LinkageProblem::finish(bool agree, ContactStep& step, const Island& island,
                            std::vector<JointState>& joints) {
  several_.settle_touches(step, island);
  // The next step begins with what acted in this one, unless that is far off.
  const double far = kFarOff * scale();
  const bool lasts = agree || error_squared() <= far * far;
  const double last = lasts ? 1.0 : 0.0;
  for (std::size_t i = 0; i < unknowns_.size(); ++i) {
    if (unknowns_[i].joint == kNoJoint) continue;
    const auto row = static_cast<Eigen::Index>(i);
    JointState& joint = joints[static_cast<std::size_t>(unknowns_[i].joint)];
    joint.pushed = lasts ? (velocity_[row] - free_[row]) / step_ : 0.0;
    laws_[i].settle(velocity_[row], joint);
  }
  for (std::size_t i = 0; i < unknowns_.size(); i += unknowns_[i].joint == kNoJoint ? 6 : 1) {
    if (unknowns_[i].joint != kNoJoint) continue;
    const auto row = static_cast<Eigen::Index>(i);
    Twist& pushed = step.bodies[static_cast<std::size_t>(unknowns_[i].body)].pushed;
    pushed.linear = last * (velocity_ - free_).segment<3>(row) / step_;
    pushed.angular = last * (velocity_ - free_).segment<3>(row + 3) / step_;
  }
  // u less M^-1 times what is missing: momenta are then those that the forces told have given.
  const double most = kNearlyAgree * scale();
  if (agree || error_squared() <= most * most) {
    direction_ = gradient_;
    solve_mass(direction_);
    velocity_ -= direction_;
  }
  body_velocity_.noalias() = jacobian_ * velocity_;
  for (std::size_t i = 0; i < island.bodies.size(); ++i) {
    const std::size_t index = island.bodies.begin()[i].body;
    const auto row = static_cast<Eigen::Index>(6 * i);
    const Body& body = step.scene.bodies[index];
    BodyState& state = step.bodies[index];
    const Quaternion& q = state.pose.orientation;
    state.linear_momentum = body.mass * body_velocity_.segment<3>(row);
    state.angular_momentum =
        q * (body.inertia * (q.conjugate() * Vector3(body_velocity_.segment<3>(row + 3))));
    if (body.flies) step.changes.mark_solved(static_cast<int>(index));
  }
}

}  // namespace mrhi
