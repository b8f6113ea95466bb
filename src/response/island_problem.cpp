#include "island_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "impact.h"

namespace mrhi {
namespace {

/// Position error at the end of the step below which a body counts as solved [m].
constexpr double kPositionTolerance = 1e-9;
/// Smallest mass ratio of an object to the operator who holds it at which both are solved together. A lighter
/// object hardly moves a person, so the operator's velocity at the start of the step is stable at any step
/// length.
constexpr double kMinCoupledMassRatio = 0.02;

/// Columns of X S, where X = [r]x + t n' maps a force at the arm r to its torque.
struct TorqueSlope {
  Triple x, y, z;
  TorqueSlope(const Symmetric3& s, const Triple& r)
      : x(r.cross({s.xx, s.xy, s.xz})), y(r.cross({s.xy, s.yy, s.yz})), z(r.cross({s.xz, s.yz, s.zz})) {}
  void tilt(double normal_slope, const Triple& t, const Triple& n) {
    x = x + (normal_slope * n.x) * t, y = y + (normal_slope * n.y) * t, z = z + (normal_slope * n.z) * t;
  }
};

/// Makes the row's drive relative to the body that carries the hand: a twist about the centre of `arm`.
void leave_carrier(const Twist& carrier, const Triple& arm, SpringContact& row) {
  const Triple spin = triple(carrier.angular);
  row.drive = row.drive - triple(carrier.linear) - spin.cross(arm);
  row.drive_spin = row.drive_spin - row.spring.normal.dot(spin);
}

}  // namespace

// s_t 1 + (s_n - s_t) n n' - slip d d' / d'd. The last term appears if friction slips: at its limit the force
// turns with the stretch d, but does not grow along it.
Symmetric3 point_slope(const SpringContact& row) {
  const SpringResponse& response = row.response;
  const double along = response.tangential_slope;
  Symmetric3 s{along, 0.0, along, 0.0, 0.0, along};
  s.add(response.normal_slope - along, row.spring.normal);
  if (response.slip > 0.0) s.add(-response.slip / std::max(response.drawn_squared, 1e-300), response.drawn);
  return s;
}

// The body's point at the arm r has the velocity J (v, w) = v - [r]x w, so J' = (1; [r]x) and
//
//     J' S J = (  S         .             )      and the twist's s_T n n' is added at the lower right
//              (  [r]x S    [r]x S [r]x'  )
//
// If the normal force acts elsewhere, by the tilt t, [r]x becomes X = [r]x + t n'. This adds s_n t n' to [r]x
// S, and s_n (m m' - (r x n) (r x n)'), m = r x n + t, to the lower right. A row of A [r]x' is r x that row
// of A, as [r]x' = -[r]x. Only the lower triangle of a symmetric block is computed.
void add_slope(const SpringContact& row, const Symmetric3& s, const Triple& r, Lower6& sum) {
  const SpringResponse& response = row.response;
  const Triple& n = row.spring.normal;
  TorqueSlope torque(s, r);
  const Triple row_x = r.cross({torque.x.x, torque.y.x, torque.z.x}),
               row_y = r.cross({torque.x.y, torque.y.y, torque.z.y}),
               row_z = r.cross({torque.x.z, torque.y.z, torque.z.z});
  Symmetric3 turn{row_x.x, row_x.y, row_y.y, row_x.z, row_y.z, row_z.z};
  turn.add(response.torque_slope, n);
  if (row.tilts) {
    const Triple lever = r.cross(n);
    turn.add(response.normal_slope, lever + row.tilt);
    turn.add(-response.normal_slope, lever);
    torque.tilt(response.normal_slope, row.tilt, n);
  }
  const Triple &x = torque.x, &y = torque.y, &z = torque.z;
  const double entries[] = {s.xx, s.xy, s.yy, s.xz,    s.yz,    s.zz,  //
                            x.x,  y.x,  z.x,  turn.xx,                 //
                            x.y,  y.y,  z.y,  turn.xy, turn.yy,        //
                            x.z,  y.z,  z.z,  turn.xz, turn.yz, turn.zz};
#pragma GCC unroll 21
  for (std::size_t i = 0; i < Cholesky6::kEntries; ++i) sum[i] += entries[i];
}

void IslandProblem::begin(const ContactStep& step, const Island& island) {
  begin(1, false);
  step_ = step.step;
  const std::size_t body = island.bodies.begin()->body;
  begin_body(step, body);
  make_rows(step, island);
  if (step.operators == nullptr || island.links.size() > 0) return;
  const int op = coupled_operator(step, island);
  if (op >= 0) couple(step, step.scene.bodies[body], step.bodies[body], op);
}

void IslandProblem::begin(std::size_t bodies, bool in_joints) {
  effort_ = Effort();
  in_joints_ = in_joints;
  coupled_ = false;
  carrier_ = Twist();
  invisible_impulse_ = std::numeric_limits<double>::infinity();
  wrenches_.resize(bodies);
  if (in_joints) return;
  for (Vector* vector :
       {&start_, &free_, &velocity_, &direction_, &gradient_, &weights_, &change_, &momentum_})
    vector->resize(6);
}

void IslandProblem::make_rows(const ContactStep& step, const Island& island) {
  make_hand_rows(step, island, rows_);
  std::size_t row = rows_.size();
  rows_.resize(row + island.links.size());
  for (const IslandContact& link : island.links)
    make_link_row(step, island, step.body_contacts[link.index], rows_[row++]);
}

// M (u - u*) contains no gyroscopic term w x I w. Only torques change L; the flight then turns the axes under
// constant L (free_flight.h).
//
//     u* = (p / m + h g, I^-1 L)          u_0 = u* + h a,     a = (u - u*) / h of the last step
//     invisible = m (1 nm) / h
void IslandProblem::begin_body(const ContactStep& step, std::size_t index) {
  const Body& body = step.scene.bodies[index];
  const BodyState& state = step.bodies[index];
  const Matrix3 rotation = state.pose.orientation.toRotationMatrix();
  one_ = {index, body.mass, rotation * body.inertia * rotation.transpose()};
  invisible_impulse_ = kPositionTolerance / step_ * body.mass;
  start_.head<3>() = state.linear_momentum / body.mass;
  start_.tail<3>() = rotation * (body.inverse_inertia * (rotation.transpose() * state.angular_momentum));
  free_ = start_;
  free_.head<3>() += step_ * step.gravity;
  velocity_.head<3>() = free_.head<3>() + step_ * state.pushed.linear;
  velocity_.tail<3>() = free_.tail<3>() + step_ * state.pushed.angular;
  weights_.head<3>().setOnes();
  weights_.tail<3>().setConstant(3.0 * body.mass / body.inertia.trace());
}

/// Returns the operator with whom the island's body is solved: that of all hands that act on it, if the body
/// is heavy enough. -1 if there is none, or several.
int IslandProblem::coupled_operator(const ContactStep& step, const Island& island) const {
  const IslandBody& body = *island.bodies.begin();
  int op = -1;
  bool several = false;
  const auto see = [&](std::size_t hand) {
    several = several || (op >= 0 && op != (*step.operators)[hand]);
    op = (*step.operators)[hand];
  };
  for (std::size_t i = body.first; i < body.last; ++i) {
    if (!step.contacts[i].ignored) see(step.contacts[i].key.hand);
  }
  for (const Grip& grip : step.grips) {
    if (grip.active && grip.body == body.body) see(grip.hand);
  }
  const double limit = step.scene.bodies[body.body].mass / kMinCoupledMassRatio;
  return several || op < 0 || step.scene.bodies[op].mass >= limit ? -1 : op;
}

// The springs' wrench acts on the body and, with opposite sign, on the operator. So the body's velocity W
// relative to the operator, both at the body's centre, is that of one body of the reduced mass:
//
//     M_r (W - W*) = h sum J' f(W),     M_r^-1 = M^-1 + X M_p^-1 X'
//
// A heavy object is then as stable in a person's hands as a light one. With d from the operator's centre to
// the body's, the blocks of X M_p^-1 X' are 1/m - [d]I^-1[d], -[d]I^-1, I^-1[d] and I^-1.
void IslandProblem::couple(const ContactStep& step, const Body& body, const BodyState& state,
                           std::size_t op) {
  const Body& person = step.scene.bodies[op];
  const BodyState& person_state = step.bodies[op];
  const Vector3 offset = state.pose.position - person_state.pose.position;
  const Twist twist = twist_of(person, person_state);
  carrier_ = {twist.linear + twist.angular.cross(offset), twist.angular};
  for (SpringContact& row : rows_) leave_carrier(carrier_, row.arm, row);
  const Matrix3 across = cross_matrix(offset);
  const Matrix3 inverse_inertia = world_inverse_inertia(person, person_state.pose.orientation);
  Eigen::Matrix<double, 6, 6> inverse;
  inverse.topLeftCorner<3, 3>() =
      collision_matrix(1.0 / person.mass + 1.0 / body.mass, inverse_inertia, offset);
  inverse.bottomLeftCorner<3, 3>() = inverse_inertia * across;
  inverse.topRightCorner<3, 3>() = -across * inverse_inertia;
  inverse.bottomRightCorner<3, 3>() = inverse_inertia + world_inverse_inertia(body, state.pose.orientation);
  const Eigen::Matrix<double, 6, 6> reduced = inverse.llt().solve(Eigen::Matrix<double, 6, 6>::Identity());
  mass_ = 0.5 * (reduced + reduced.transpose());
  // Gravity accelerates both alike, so it has no effect on the relative velocity.
  start_.head<3>() -= carrier_.linear;
  start_.tail<3>() -= carrier_.angular;
  free_ = start_;
  velocity_.head<3>() = free_.head<3>() + step_ * state.pushed.linear;
  velocity_.tail<3>() = free_.tail<3>() + step_ * state.pushed.angular;
  coupled_ = true;
}

// Body 1 of the rows is the operator; body 2 is a fixture, which has no number: u = u_1 + v + w x r, with u_1
// the hand's velocity relative to the operator.
void IslandProblem::begin_operator(const ContactStep& step, std::size_t body,
                                   const std::vector<Contact*>& contacts, const Twist& carrier) {
  begin(1, false);
  step_ = step.step;
  begin_body(step, body);
  rows_.resize(contacts.size());
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    SpringContact& row = rows_[i];
    make_spring(step, *contacts[i], row);
    row.a = 0, row.b = SpringContact::kNone;
    row.arm_a = triple(contacts[i]->point - step.bodies[body].pose.position);
    leave_carrier(carrier, row.arm_a, row);
  }
}

//     u = u_1 - (v + w x r) - (w.t) n,     spin = n.(w_1 - w)
[[gnu::always_inline]] inline void IslandProblem::relative_motion(const SpringContact& row, Triple& velocity,
                                                                  double& spin) const {
  const Triple& n = row.spring.normal;
  velocity = row.drive, spin = row.drive_spin;
  if (row.b != SpringContact::kNone) {
    const Triple w = angular_velocity(row.b);
    velocity = velocity - linear_velocity(row.b) - w.cross(row.arm);
    if (row.tilts) velocity = velocity - w.dot(row.tilt) * n;
    spin -= n.dot(w);
  }
  if (row.a != SpringContact::kNone) {
    const Triple w = angular_velocity(row.a);
    velocity = velocity + linear_velocity(row.a) + w.cross(row.arm_a);
    if (row.tilts) velocity = velocity + w.dot(row.tilt) * n;
    spin += n.dot(w);
  }
}

/// Backward Euler. The gradient is the residual impulse of M (u - u*) = h J' f(J u). While friction's limits
/// are held it is also the gradient of energy(). A row applies f to its body 2 and -f to body 1:
///
///     g = M (u - u*) - h J' (sum f, sum r x f + (f.n) t + T n)
///
/// This is velocity-level time stepping (Anitescu & Potra 1997) with springs in place of constraints, so it
/// needs no complementarity problem. It is convex as in Todorov (2014) and, with springs, Castro, Permenter &
/// Han (2023).
void IslandProblem::evaluate(bool renew_limits) {
  if (in_joints_) find_body_velocities();
  std::fill(wrenches_.begin(), wrenches_.end(), Wrench{});
  double load = 0.0;
  for (SpringContact& row : rows_) {
    Triple velocity;
    double spin;
    relative_motion(row, velocity, spin);
    SpringResponse& response = row.response;
    row.spring.evaluate(velocity, spin, renew_limits, response);
    load += response.normal_force + row.spring.bond;
    Triple torque = response.torque * row.spring.normal;
    if (row.tilts) torque = torque + response.force.dot(row.spring.normal) * row.tilt;
    if (row.b != SpringContact::kNone) {
      Wrench& sum = wrenches_[row.b];
      sum.force = sum.force + response.force;
      sum.torque = sum.torque + (row.arm.cross(response.force) + torque);
    }
    if (row.a != SpringContact::kNone) {
      Wrench& sum = wrenches_[row.a];
      sum.force = sum.force - response.force;
      sum.torque = sum.torque - (row.arm_a.cross(response.force) + torque);
    }
  }
  scale_ = step_ * load;
  change_ = velocity_ - free_;
  multiply_mass(change_, gradient_);
  Vector& impulse = in_joints_ ? body_impulse_ : gradient_;
  if (in_joints_) impulse.setZero();
  Eigen::Index at = 0;
  for (const Wrench& wrench : wrenches_) {
    impulse.segment<3>(at) -= step_ * vector(wrench.force);
    impulse.segment<3>(at + 3) -= step_ * vector(wrench.torque);
    at += 6;
  }
  if (in_joints_) add_joint_forces();
}

void IslandProblem::multiply_mass(const Vector& by, Vector& result) const {
  if (coupled_) {
    result.noalias() = mass_ * by;
    return;
  }
  if (in_joints_) {
    for (const Part& part : parts_) {
      const auto [first, count] = part.columns;
      result.segment(first, count).noalias() =
          mass_.block(first, first, count, count) * by.segment(first, count);
    }
    return;
  }
  result.head<3>() = one_.mass * by.head<3>();
  result.tail<3>() = one_.inertia * by.tail<3>();
}

/// H = M + h sum J' S J: positive definite, as no row's S has a negative eigenvalue.
void IslandProblem::factorise() {
  if (in_joints_) return factorise_joints();
  Lower6 sum{};
  for (const SpringContact& row : rows_) {
    if (row.response.normal_slope <= 0.0 && row.response.tangential_slope <= 0.0) continue;
    add_slope(row, point_slope(row), row.b != SpringContact::kNone ? row.arm : row.arm_a, sum);
  }
  for (double& one : sum) one *= step_;
  const auto entry = [&sum](int row, int column) -> double& { return sum[Cholesky6::at(row, column)]; };
  for (int row = 0; coupled_ && row < 6; ++row) {
    for (int column = 0; column <= row; ++column) entry(row, column) += mass_(row, column);
  }
  for (int row = 0; !coupled_ && row < 3; ++row) {
    entry(row, row) += one_.mass;
    for (int column = 0; column <= row; ++column) entry(3 + row, 3 + column) += one_.inertia(row, column);
  }
  factors_of_one_.factorise(sum);
}

void IslandProblem::find_direction() {
  direction_ = -gradient_;
  if (in_joints_) {
    factors_.solve_in_place(direction_);
  } else {
    direction_ = factors_of_one_.solve(direction_);
  }
}

/// Squared residual in (N s)^2: |g_v|^2 + |g_w|^2 / k^2. An angular impulse counts as the impulse that causes
/// it at the radius of gyration k, with k^2 = tr I / 3m the mean over the axes.
double IslandProblem::error_squared() const {
  return (weights_.array() * gradient_.array().square()).sum();
}

/// (u - u*)' M (u - u*) / 2 + h sum V(J u), with V the potential whose slope is -f. It is convex, and its
/// minimum is the step's solution (Kane, Marsden, Ortiz & West, Variational integrators, IJNME 49, 2000).
/// Only a line search needs it.
double IslandProblem::energy() {
  if (in_joints_) find_body_velocities();
  change_ = velocity_ - free_;
  multiply_mass(change_, momentum_);
  double sum = 0.5 * change_.dot(momentum_);
  for (const SpringContact& row : rows_) {
    if (row.spring.stiffness <= 0.0) continue;
    Triple velocity;
    double spin;
    relative_motion(row, velocity, spin);
    sum += step_ * potential(row.spring, velocity, spin);
  }
  return in_joints_ ? sum + joint_energy() : sum;
}

// Momenta consistent with the forces are M u* + h J' f: one body gains what the other loses, however far u
// has converged. If a body is solved with its operator, this always holds, as no other momenta are known.
void IslandProblem::finish_body(bool agree, ContactStep& step) const {
  BodyState& state = step.bodies[one_.index];
  state.pushed.linear = (velocity_.head<3>() - free_.head<3>()) / step_;
  state.pushed.angular = (velocity_.tail<3>() - free_.tail<3>()) / step_;
  if (agree || coupled_) {
    state.linear_momentum += step_ * (vector(wrenches_[0].force) + one_.mass * step.gravity);
    state.angular_momentum += step_ * vector(wrenches_[0].torque);
  } else {
    state.linear_momentum = one_.mass * velocity_.head<3>();
    state.angular_momentum = one_.inertia * velocity_.tail<3>();
  }
}

void IslandProblem::settle_rows(ContactStep& step, const Island& island) const {
  const SpringContact* row = settle_hand_rows(step, island, rows_.data());
  for (const IslandContact& link : island.links) settle(step, *row++, step.body_contacts[link.index]);
}

void IslandProblem::finish(bool agree, ContactStep& step, const Island& island) {
  finish_body(agree, step);
  settle_rows(step, island);
}

void IslandProblem::finish_operator(ContactStep& step, const std::vector<Contact*>& contacts) {
  finish_body(true, step);
  for (std::size_t i = 0; i < contacts.size(); ++i) settle(step, rows_[i], *contacts[i]);
}

}  // namespace mrhi
