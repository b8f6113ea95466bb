#include "body_problem.h"

#include "spring_contact.h"

namespace mrhi {
namespace {

/// Fills the last four up.
template <typename Touch>
void fill_up(Touch& none, std::vector<Touch*>& touches) {
  while (touches.size() % kLanes != 0) touches.push_back(&none);
}

}  // namespace

BodyProblem::BodyProblem() {
  no_contact_.share = no_body_contact_.share = 0.0;
}

void BodyProblem::begin(ContactStep& step, const Island& island, const ContactConfiguration& configuration) {
  const IslandBody& touched = island.bodies.begin()[0];
  hands_.clear(), objects_.clear();
  for (std::size_t i = touched.first; i < touched.last; ++i) {
    if (!step.contacts[i].ignored) hands_.push_back(&step.contacts[i]);
  }
  for (const Link& link : island.links) objects_.push_back(&step.body_contacts[link.index]);
  fill_up(no_contact_, hands_);
  fill_up(no_body_contact_, objects_);
  grips_.clear();
  for (Grip& grip : step.grips) {
    if (grip.active && grip.body == touched.body) grips_.push_back(&grip);
  }
  static_assert(kGripPoints == kLanes, "a grip fills one group of lanes");
  springs_.resize((hands_.size() + objects_.size()) / kLanes + grips_.size());
  auto spring = springs_.begin();
  for (std::size_t i = 0; i < hands_.size(); i += kLanes)
    make_springs(step, configuration, &hands_[i], *spring++);
  for (std::size_t i = 0; i < objects_.size(); i += kLanes)
    make_springs(step, configuration, &objects_[i], *spring++);
  for (const Grip* grip : grips_) {
    SpringContact<double> one;
    for (int point = 0; point < kGripPoints; ++point) {
      make_grip_spring(step, configuration, *grip, point, one);
      put_in(point, one, *spring);
    }
    ++spring;
  }

  step_ = step.step;
  begin_body(step.scene.bodies[touched.body], step.bodies[touched.body], step.gravity);
}

// The unknown is V = (v, w), world axes, w about the centre of mass, with M = diag(m 1, R I R') at the
// step's start. No gyroscopic term w x I w is in it: it is what the axes' turning does, L itself changes by
// torques alone, and the flight turns the axes under L afterwards (free_flight.h).
//
//     V* = (p / m + h g, I^-1 L)          V_0 = V* + h a,     a = (V - V*) / h of the last step
//     unseen = m (1 nm) / h
void BodyProblem::begin_body(const Body& body, const BodyState& state, const Vector3& gravity) {
  mass_ = body.mass;
  unseen_ = kUnseenWay / step_ * mass_;
  const Matrix3 rotation = state.pose.orientation.toRotationMatrix();
  inertia_ = rotation * body.inertia * rotation.transpose();
  gyration_squared_ = body.inertia.trace() / (3.0 * body.mass);
  // Newton's method begins where the forces of the step before would bring the body.
  start_.head<3>() = state.linear_momentum / body.mass;
  start_.tail<3>() = rotation * (body.inverse_inertia * (rotation.transpose() * state.angular_momentum));
  free_ = start_;
  free_.head<3>() += step_ * gravity;
  velocity_.head<3>() = free_.head<3>() + step_ * state.pushed.linear;
  velocity_.tail<3>() = free_.tail<3>() + step_ * state.pushed.angular;
}

// Backward Euler: M (v - v_free) = h J' f(v), with forces as they are at the step's end. The gradient is the
// impulse that is still missing.
//
//     g = M (V - V*) - h (sum f, sum r x f + T n)                  [N s], [N m s]
//
// This is time stepping on velocities as Anitescu & Potra (1997) have it, with springs, which need no
// complementarity problem, in place of constraints; convex as Todorov (2014) and, with springs, Castro,
// Permenter & Han (2023) have it.
void BodyProblem::evaluate(bool renew_limits) {
  lanes_.respond(springs_.data(), springs_.data() + springs_.size(), velocity_.data(), renew_limits, sum_);
  const Vector6 change = velocity_ - free_;
  gradient_.head<3>() = mass_ * change.head<3>() - step_ * Eigen::Map<const Vector3>(sum_.force);
  gradient_.tail<3>() = inertia_ * change.tail<3>() - step_ * Eigen::Map<const Vector3>(sum_.torque);
}

// M - h J' (df/dv) J: symmetric, and positive definite as no contact's slope is negative.
// H = M + h sum J' S J of SpringLanes::slope().
void BodyProblem::factorise() {
  SpringSlope slope;
  lanes_.slope(springs_.data(), springs_.data() + springs_.size(), slope);
  for (double& entry : slope.entry) entry *= step_;
  for (int i = 0; i < 3; ++i) {
    slope.entry[Cholesky6::at(i, i)] += mass_;
    for (int j = 0; j <= i; ++j) slope.entry[Cholesky6::at(3 + i, 3 + j)] += inertia_(i, j);
  }
  factors_.factorise(slope.entry);
}

// In N s: an angular impulse counts as the impulse that gives it at the radius of gyration.
// |g_v|^2 + |g_w|^2 / k^2, k^2 = tr I / 3m the mean over the axes of their squared radii of gyration.
double BodyProblem::error_squared() const {
  return gradient_.head<3>().squaredNorm() + gradient_.tail<3>().squaredNorm() / gyration_squared_;
}

// E(V) = (V - V*)' M (V - V*) / 2 + h sum V_c(u_c), whose gradient by V is g: u falls with V, and the
// potential's gradient by u is the force on 2. Only a line search asks for it, contact by contact.
double BodyProblem::energy() const {
  const Vector6 change = velocity_ - free_;
  double energy =
      0.5 * (mass_ * change.head<3>().squaredNorm() + change.tail<3>().dot(inertia_ * change.tail<3>()));
  const Triple<double> linear = triple(velocity_.head<3>()), angular = triple(velocity_.tail<3>());
  for (const SpringContact<Lanes>& four : springs_) {
    for (int lane = 0; lane < kLanes; ++lane) {
      const SpringContact<double> one = contact_in(lane, four);
      if (one.spring.stiffness <= 0.0) continue;
      const Triple<double> u = one.drive - linear - angular.cross(one.arm);
      energy += step_ * potential(one.spring, u, one.drive_spin - one.spring.normal.dot(angular));
    }
  }
  return energy;
}

void BodyProblem::finish(bool agree, ContactStep& step, const Island& island) const {
  BodyState& state = step.bodies[island.bodies.begin()[0].body];
  state.pushed.linear = (velocity_ - free_).head<3>() / step_;
  state.pushed.angular = (velocity_ - free_).tail<3>() / step_;
  state.linear_momentum = mass_ * velocity_.head<3>();
  state.angular_momentum = inertia_ * velocity_.tail<3>();
  // M v less what is missing is M v_free + h J' f: momentum changes by what the contacts give, to rounding,
  // and what one body gains another loses.
  if (agree) {
    state.linear_momentum -= gradient_.head<3>();
    state.angular_momentum -= gradient_.tail<3>();
  }
  auto spring = springs_.begin();
  for (std::size_t i = 0; i < hands_.size(); i += kLanes) settle(step, *spring++, &hands_[i]);
  for (std::size_t i = 0; i < objects_.size(); i += kLanes) settle(step, *spring++, &objects_[i]);
  for (Grip* grip : grips_) {
    for (int point = 0; point < kGripPoints; ++point)
      settle_grip(step, contact_in(point, *spring), point, *grip);
    ++spring;
  }
}

}  // namespace mrhi
