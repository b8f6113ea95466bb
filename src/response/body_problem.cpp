#include "body_problem.h"

#include <algorithm>
#include <limits>

#include "impact.h"
#include "spring_contact.h"

namespace mrhi {
namespace {

/// An object that is heavier than this, in masses of the operator who holds it, is solved together with the
/// operator. A lighter one hardly moves a person: there the operator's velocity of the step's start is stable
/// at any step.
constexpr double kMinCoupled = 0.02;

double lightest_operator(const Scene& scene) {
  double lightest = std::numeric_limits<double>::infinity();
  for (const Operator& op : scene.operators)
    lightest = std::min(lightest, scene.bodies[static_cast<std::size_t>(op.body)].mass);
  return lightest;
}

}  // namespace

/// The first contact of each kind begins with the first partial sum.
template <typename Contacts>
void BodyProblem::make_springs(const ContactStep& step, const ContactConfiguration& configuration,
                               const Contacts& contacts, BodySpring* spring) {
  for (std::size_t i = 0; i < contacts.size(); ++i, ++spring) {
    spring->part = static_cast<int>(i % kParts);
    make_spring(step, configuration, *contacts[i], *spring);
  }
}

void BodyProblem::begin(ContactStep& step, const Island& island, const ContactConfiguration& configuration) {
  const IslandBody& touched = island.bodies.begin()[0];
  hands_.clear(), objects_.clear();
  for (std::size_t i = touched.first; i < touched.last; ++i) {
    if (!step.contacts[i].ignored) hands_.push_back(&step.contacts[i]);
  }
  for (const Link& link : island.links) objects_.push_back(&step.body_contacts[link.index]);
  grips_.clear();
  for (Grip& grip : step.grips) {
    if (grip.active && grip.body == touched.body) grips_.push_back(&grip);
  }
  springs_.resize(hands_.size() + objects_.size() + kGripPoints * grips_.size());
  BodySpring* spring = springs_.data();
  make_springs(step, configuration, hands_, spring);
  make_springs(step, configuration, objects_, spring += hands_.size());
  spring += objects_.size();
  static_assert(kGripPoints == kParts, "a grip has one point in each partial sum");
  for (const Grip* grip : grips_) {
    for (int point = 0; point < kGripPoints; ++point, ++spring) {
      spring->part = point;
      make_grip_spring(step, configuration, *grip, point, *spring);
    }
  }

  step_ = step.step;
  const Body& body = step.scene.bodies[touched.body];
  const BodyState& state = step.bodies[touched.body];
  begin_body(body, state, step.gravity);
  coupled_ = false;
  if (step.operators == nullptr || !objects_.empty()) return;
  if (body.mass <= kMinCoupled * lightest_operator(step.scene)) return;
  const int op = sole_operator(step);
  if (op >= 0 && body.mass > kMinCoupled * step.scene.bodies[static_cast<std::size_t>(op)].mass)
    couple(step, body, state, static_cast<std::size_t>(op));
}

/// The operator of all hands that press the body; -1 if there are several.
int BodyProblem::sole_operator(const ContactStep& step) const {
  int op = -1;
  bool several = false;
  const auto see = [&](std::size_t hand) {
    several = several || (op >= 0 && op != (*step.operators)[hand]);
    op = (*step.operators)[hand];
  };
  for (const Contact* contact : hands_) see(contact->key.hand);
  for (const Grip* grip : grips_) see(grip->hand);
  return several ? -1 : op;
}

namespace {

/// The drive of a spring without the motion of what carries its end, a twist at the centre of its arm.
void leave_carrier(const Twist& carrier, SpringContact& spring) {
  const Triple spin = triple(carrier.angular);
  spring.drive = spring.drive - triple(carrier.linear) - spin.cross(spring.arm);
  spring.drive_spin = spring.drive_spin - spring.spring.normal.dot(spin);
}

}  // namespace

// The wrench of the springs acts on the body and, opposite, on the operator. So the velocity W of the body
// against the operator, both at the body's centre, is that of one body of the reduced mass:
//
//     M_r (W - W*) = h sum J' f(W),     M_r^-1 = M^-1 + X M_p^-1 X'
//
// and a heavy object is as stable in the hands of a person as a light one. X M_p^-1 X' has, with d from the
// operator's centre to the body's, the blocks 1/m - [d]I^-1[d], -[d]I^-1, I^-1[d] and I^-1.
void BodyProblem::couple(const ContactStep& step, const Body& body, const BodyState& state, std::size_t op) {
  const Body& person = step.scene.bodies[op];
  const BodyState& person_state = step.bodies[op];
  const Vector3 offset = state.pose.position - person_state.pose.position;
  const Twist twist = twist_of(person, person_state);
  carrier_ = {twist.linear + twist.angular.cross(offset), twist.angular};
  for (BodySpring& spring : springs_) leave_carrier(carrier_, spring);
  const Matrix3 across = cross_matrix(offset);
  const Matrix3 inverse_inertia = world_inverse_inertia(person, person_state.pose.orientation);
  Matrix6 inverse;
  inverse.topLeftCorner<3, 3>() =
      collision_matrix(1.0 / person.mass + 1.0 / body.mass, inverse_inertia, offset);
  inverse.bottomLeftCorner<3, 3>() = inverse_inertia * across;
  inverse.topRightCorner<3, 3>() = -across * inverse_inertia;
  inverse.bottomRightCorner<3, 3>() = inverse_inertia + world_inverse_inertia(body, state.pose.orientation);
  reduced_ = inverse.llt().solve(Matrix6::Identity());
  reduced_ = (0.5 * (reduced_ + reduced_.transpose())).eval();
  // Both fall alike, so that gravity has no part in the velocity against each other.
  free_.head<3>() = start_.head<3>() -= carrier_.linear;
  free_.tail<3>() = start_.tail<3>() -= carrier_.angular;
  velocity_.head<3>() = free_.head<3>() + step_ * state.pushed.linear;
  velocity_.tail<3>() = free_.tail<3>() + step_ * state.pushed.angular;
  gravity_ = step.gravity;
  coupled_ = true;
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

// Of all springs on a body with velocity v and angular velocity w, at arms r from its centre:
//
//     u = u_1 - (v + w x r) - (w.t) n,     spin = n.(w_1 - w)
//     F = sum f,                           T = sum r x f + (f.n) t + T_n n
SpringSum respond(Triple velocity, Triple spin, bool renew_limits, std::vector<BodySpring>& springs) {
  SpringSum parts[kParts] = {};
  for (BodySpring& spring : springs) {
    const Triple& n = spring.spring.normal;
    const Triple u = spring.relative_velocity(velocity, spin);
    SpringResponse& response = spring.response;
    spring.spring.respond(u, spring.drive_spin - n.dot(spin), renew_limits, response);
    SpringSum& sum = parts[spring.part];
    sum.force = sum.force + response.force;
    sum.torque = sum.torque + spring.torque();
    sum.push = sum.push + response.push + spring.spring.bond;
  }
  return {(parts[0].force + parts[1].force) + (parts[2].force + parts[3].force),
          (parts[0].torque + parts[1].torque) + (parts[2].torque + parts[3].torque),
          (parts[0].push + parts[1].push) + (parts[2].push + parts[3].push)};
}

namespace {

/// A symmetric matrix.
struct Symmetric3 {
  double xx, xy, yy, xz, yz, zz;

  /// Adds weight v v'.
  void add(double weight, const Triple& v) {
    const Triple w = weight * v;
    xx += w.x * v.x, xy += w.x * v.y, yy += w.y * v.y;
    xz += w.x * v.z, yz += w.y * v.z, zz += w.z * v.z;
  }
};

}  // namespace

// The point of the body at the arm r moves by J (v, w) = v - [r]x w, so J' = (1; [r]x) and
//
//     J' S J = (  S         .             )      S = s_t 1 + (s_n - s_t) n n' - slip d d' / d'd
//              (  [r]x S    [r]x S [r]x'  )      and the twist's s_T n n' is added at the lower right
//
// and where the push acts elsewhere, by the tilt t, [r]x becomes [r]x + t n': that adds s_n t n' to [r]x S
// and s_n (m m' - (r x n) (r x n)'), m = r x n + t, to the lower right. s are the slopes of SpringResponse. A
// row of A [r]x' is r x that row of A, as [r]x' = -[r]x. Only the lower triangle is summed, in three blocks:
// what is symmetric is made once.
SpringSlope slope_of(const std::vector<BodySpring>& springs) {
  SpringSlope parts[kParts] = {};
  for (const BodySpring& spring : springs) {
    const SpringResponse& response = spring.response;
    const Triple& r = spring.arm;
    const Triple& n = spring.spring.normal;
    // S of the contact point; [r]x S, of the torque by the velocity; and [r]x S [r]x' with the twist's.
    const double along = response.tangential_slope;
    Symmetric3 s{along, 0.0, along, 0.0, 0.0, along};
    s.add(response.normal_slope - along, n);
    if (response.slip > 0.0) s.add(-response.slip / std::max(response.drawn_squared, 1e-300), response.drawn);
    Triple x = r.cross({s.xx, s.xy, s.xz}), y = r.cross({s.xy, s.yy, s.yz}), z = r.cross({s.xz, s.yz, s.zz});
    const Triple row_x = r.cross({x.x, y.x, z.x}), row_y = r.cross({x.y, y.y, z.y}),
                 row_z = r.cross({x.z, y.z, z.z});
    Symmetric3 turn{row_x.x, row_x.y, row_y.y, row_x.z, row_y.z, row_z.z};
    turn.add(response.torque_slope, n);
    if (spring.tilts) {
      const Triple &t = spring.tilt, lever = r.cross(n);
      turn.add(response.normal_slope, lever + t);
      turn.add(-response.normal_slope, lever);
      x = x + (response.normal_slope * n.x) * t, y = y + (response.normal_slope * n.y) * t;
      z = z + (response.normal_slope * n.z) * t;
    }
    const double entries[] = {s.xx, s.xy, s.yy, s.xz,    s.yz,    s.zz,  //
                              x.x,  y.x,  z.x,  turn.xx,                 //
                              x.y,  y.y,  z.y,  turn.xy, turn.yy,        //
                              x.z,  y.z,  z.z,  turn.xz, turn.yz, turn.zz};
    SpringSlope& sum = parts[spring.part];
#pragma GCC unroll 21
    for (int i = 0; i < Cholesky6::kEntries; ++i) sum.entry[i] += entries[i];
  }
  SpringSlope result;
#pragma GCC unroll 21
  for (int i = 0; i < Cholesky6::kEntries; ++i) {
    const auto of = [&](int part) { return parts[part].entry[i]; };
    result.entry[i] = (of(0) + of(1)) + (of(2) + of(3));
  }
  return result;
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
  sum_ = respond(triple(velocity_.head<3>()), triple(velocity_.tail<3>()), renew_limits, springs_);
  const Vector3 impulse = step_ * vector(sum_.force), turn = step_ * vector(sum_.torque);
  const Vector6 change = velocity_ - free_;
  if (coupled_) {
    gradient_ = reduced_ * change;
    gradient_.head<3>() -= impulse;
    gradient_.tail<3>() -= turn;
    return;
  }
  gradient_.head<3>() = mass_ * change.head<3>() - impulse;
  gradient_.tail<3>() = inertia_ * change.tail<3>() - turn;
}

// M - h J' (df/dv) J: symmetric, and positive definite as no contact's slope is negative.
// H = M + h sum J' S J of slope_of().
void BodyProblem::factorise() {
  SpringSlope slope = slope_of(springs_);
  for (double& entry : slope.entry) entry *= step_;
  for (int i = 0; coupled_ && i < 6; ++i) {
    for (int j = 0; j <= i; ++j) slope.entry[Cholesky6::at(i, j)] += reduced_(i, j);
  }
  for (int i = 0; !coupled_ && i < 3; ++i) {
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
  double energy = coupled_ ? 0.5 * change.dot(reduced_ * change)
                           : 0.5 * (mass_ * change.head<3>().squaredNorm() +
                                    change.tail<3>().dot(inertia_ * change.tail<3>()));
  const Triple linear = triple(velocity_.head<3>()), angular = triple(velocity_.tail<3>());
  for (const BodySpring& one : springs_) {
    if (one.spring.stiffness <= 0.0) continue;
    const Triple u = one.relative_velocity(linear, angular);
    energy += step_ * potential(one.spring, u, one.drive_spin - one.spring.normal.dot(angular));
  }
  return energy;
}

void BodyProblem::finish_body(bool agree, BodyState& state) const {
  if (coupled_) {
    const Vector3 impulse = step_ * vector(sum_.force), turn = step_ * vector(sum_.torque);
    state.pushed = {(velocity_ - free_).head<3>() / step_, (velocity_ - free_).tail<3>() / step_};
    state.linear_momentum += impulse + step_ * mass_ * gravity_;
    state.angular_momentum += turn;
    return;
  }
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
}

void BodyProblem::finish(bool agree, ContactStep& step, const Island& island) const {
  finish_body(agree, step.bodies[island.bodies.begin()[0].body]);
  auto spring = springs_.begin();
  for (Contact* contact : hands_) settle(step, *spring++, *contact);
  for (BodyContact* contact : objects_) settle(step, *spring++, *contact);
  for (Grip* grip : grips_) {
    for (int point = 0; point < kGripPoints; ++point) settle_grip(step, *spring++, point, *grip);
  }
}

namespace {

/// The same with the opposite momenta.
BodyState opposite(const BodyState& state) {
  BodyState result = state;
  result.linear_momentum = -state.linear_momentum;
  result.angular_momentum = -state.angular_momentum;
  result.pushed = {-state.pushed.linear, -state.pushed.angular};
  return result;
}

}  // namespace

// A hand's point has the velocity d + v + w x r, where v and w are the operator's, r the arm from its centre
// and d its own. A fixture's point stands still, so
//
//     u = d + v + w x r = d - (V + W x r),      V = -v,  W = -w
//
// which is u of a body with the velocity V and a hand with the velocity d. The force f on the fixture changes
// the operator's momentum by -h f, and the opposite momentum by h f, as it would the body's.
void BodyProblem::begin_operator(ContactStep& step, std::size_t body, const std::vector<Contact*>& contacts,
                                 const Twist& carrier, const ContactConfiguration& configuration) {
  objects_.clear(), grips_.clear();
  hands_ = contacts;
  springs_.resize(hands_.size());
  make_springs(step, configuration, hands_, springs_.data());
  const Vector3& centre = step.bodies[body].pose.position;
  for (std::size_t i = 0; i < hands_.size(); ++i) {
    BodySpring& spring = springs_[i];
    const std::size_t fixture = hands_[i]->key.body;
    // Each fixture begins with the first partial sum.
    const bool same = i > 0 && hands_[i - 1]->key.body == fixture;
    spring.part = same ? (springs_[i - 1].part + 1) % kParts : 0;
    spring.arm = spring.arm + triple(step.bodies[fixture].pose.position - centre);
    leave_carrier(carrier, spring);
  }
  coupled_ = false;
  step_ = step.step;
  begin_body(step.scene.bodies[body], opposite(step.bodies[body]), -step.gravity);
}

void BodyProblem::finish_operator(bool agree, ContactStep& step, std::size_t body) {
  BodyState state = opposite(step.bodies[body]);
  if (!agree) evaluate(true);  // it has moved on since
  finish_body(true, state);
  step.bodies[body] = opposite(state);
  for (std::size_t i = 0; i < hands_.size(); ++i) settle(step, springs_[i], *hands_[i]);
}

}  // namespace mrhi
