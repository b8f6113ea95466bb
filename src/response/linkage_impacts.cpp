#include "linkage_impacts.h"

#include <algorithm>

#include "../collision/god_object.h"
#include "impact.h"

namespace mrhi {
namespace {

constexpr int kSweeps = 500;
constexpr double kConverged = 1e-13;  // of the approach velocity
/// Impulses that grow beyond this multiple of what the blow needs have no end.
constexpr double kPressed = 4.0;

/// Velocity of a body's point by the unknowns, times `sign`, added.
///
///     c' = v + w x r = (J_v - [r]x J_w) u
void add_point_rows(const LinkageProblem& problem, int place, const Vector3& arm, double sign,
                    Eigen::Matrix<double, 3, Eigen::Dynamic>& rows) {
  const auto linear = problem.jacobian().middleRows<3>(6 * place);
  const auto angular = problem.jacobian().middleRows<3>(6 * place + 3);
  rows += sign * linear - (sign * cross_matrix(arm)).lazyProduct(angular);
}

}  // namespace

// Every strike is a row w of relative velocity, w = drive + J_1 u - J_2 u: of a hand, whose point moves by
// itself, body 2 alone has unknowns; of two bodies both. n points from 2 to 1, so w.n < 0 approaches (Eq. 8).
bool LinkageImpacts::find(ContactStep& step, const Island& island, const LinkageProblem& problem,
                          const std::vector<JointState>& joints) {
  count_ = 0;
  const auto material = [&](std::size_t body) -> const Material& { return step.scene.bodies[body].material; };
  for (const IslandBody& body : island.bodies) {
    const int place = island.place_of(static_cast<int>(body.body));
    for (std::size_t i = body.first; i < body.last; ++i) {
      Contact& contact = step.contacts[i];
      if (contact.ignored || contact.struck) continue;
      Strike& strike = next();
      strike.hand = &contact;
      strike.normal = contact.normal, strike.drive = contact.hand_velocity;
      strike.gap = -contact.depth;
      strike.restitution = contact.restitution.value_or(material(body.body).restitution);
      strike.friction = material(body.body).static_friction;
      strike.inverse_mass = contact.inverse_mass + contact.carrier_inverse_mass;
      const Vector3 arm = contact.point - step.bodies[body.body].pose.position;
      strike.rows.setZero(3, problem.jacobian().cols());
      add_point_rows(problem, place, arm, -1.0, strike.rows);
      add(step.step, problem);
    }
  }
  for (const Link& link : island.links) {
    BodyContact& contact = step.body_contacts[link.index];
    if (contact.struck) continue;
    Strike& strike = next();
    strike.between = &contact;
    strike.normal = contact.normal, strike.drive.setZero();
    strike.gap = contact.first_touch >= 0.0 ? 0.0 : -contact.depth;
    strike.restitution = contact.material.restitution;
    strike.friction = contact.material.static_friction;
    strike.rows.setZero(3, problem.jacobian().cols());
    add_point_rows(problem, island.place_of(contact.key.b), contact.arm_b, -1.0, strike.rows);
    if (!step.scene.bodies[contact.key.a].fixed)
      add_point_rows(problem, island.place_of(contact.key.a), contact.arm_a, 1.0, strike.rows);
    add(step.step, problem);
  }
  find_limits(step, problem, joints);
  return count_ > 0;
}

/// A limit that a joint meets within the step is struck as a surface is: springs and gravity, which push on
/// through the step, then find it on its way back, and give it no energy that they have not.
///
///     room = upper - q for u > 0, q - lower for u < 0;   meets if 0 < room < h |u|
///     w = -sign u: < 0 approaches, as of surfaces; the impulse on the joint is -sign j
void LinkageImpacts::find_limits(const ContactStep& step, const LinkageProblem& problem,
                                 const std::vector<JointState>& joints) {
  for (Eigen::Index unknown = 0; unknown < problem.start().size(); ++unknown) {
    if (problem.joint_of(unknown) == LinkageBody::kNone) continue;
    const auto index = static_cast<std::size_t>(problem.joint_of(unknown));
    const Joint& joint = step.scene.joints[index];
    const double sign = problem.start()[unknown] > 0.0 ? 1.0 : -1.0, position = joints[index].position;
    const double room = sign > 0.0 ? joint.upper - position : position - joint.lower;
    const bool meets = room > 0.0 && sign * problem.start()[unknown] * step.step > room;
    if (joint.restitution <= 0.0 || !meets) continue;
    Strike& strike = next();
    strike.joint = unknown;
    strike.normal = Vector3::UnitX(), strike.drive.setZero();
    strike.gap = room;
    strike.restitution = joint.restitution;
    strike.friction = 0.0;
    strike.rows.setZero(3, problem.jacobian().cols());
    strike.rows(0, unknown) = -sign;
    add(step.step, problem);
  }
}

LinkageImpacts::Strike& LinkageImpacts::next() {
  if (count_ == strikes_.size()) strikes_.emplace_back();
  Strike& strike = strikes_[count_];
  strike.hand = nullptr, strike.between = nullptr, strike.joint = -1;
  strike.inverse_mass = strike.magnitude = 0.0;
  strike.drag.setZero(), strike.recoil.setZero();
  return strike;
}

/// Gravity acts within the step only as far as it lets what is at rest fall: a strike has the velocity of the
/// step's start.
void LinkageImpacts::add(double step, const LinkageProblem& problem) {
  Strike& strike = strikes_[count_];
  const double rate = strike.normal.dot(strike.relative_velocity(problem.start()));
  if (classify(rate) != Approach::colliding) return;
  strike.time = time_to_close(strike.gap, rate, 0.0);
  if (strike.between != nullptr && strike.between->first_touch >= 0.0)
    strike.time = strike.between->first_touch;
  if (strike.time < step) ++count_;
}

void LinkageImpacts::spare_carried(const ContactStep& step, const LinkageProblem::Vector& velocity) {
  const auto parts = [&](const Strike& strike) {
    return strike.hand != nullptr &&
           strike.gap + step.step * strike.normal.dot(strike.relative_velocity(velocity)) > 0.0;
  };
  // The room of those left out stays, behind those kept.
  const auto end = strikes_.begin() + static_cast<std::ptrdiff_t>(count_);
  std::size_t kept = 0;
  for (auto strike = strikes_.begin(); strike != end; ++strike) {
    if (!parts(*strike)) std::swap(strikes_[kept++], *strike);
  }
  count_ = kept;
}

/// W = J M^-1 J' + 1/m_hand: change of the relative velocity by an impulse there, with all that joints pass
/// on. The normal's effective mass is 1 / n'Wn; across n, one number below both, of the trace.
///
///     W n j is what n j does:  m_n = 1 / n'Wn,     M_t = P / tr(P W P) <= the inverse of P W P across n
///
/// A trace is at least the larger eigenvalue, so friction is relaxed by less than it might be and does not
/// overshoot. J M^-1 J' may be singular, where the inverse that strikes of free bodies have would be
/// infinite.
void LinkageImpacts::prepare(const LinkageProblem& problem, Strike& strike) {
  strike.answer.resize(strike.rows.cols(), 3);
  for (int i = 0; i < 3; ++i) {
    column_ = strike.rows.row(i).transpose();
    problem.solve_mass(column_);
    strike.answer.col(i) = column_;
  }
  const Vector3& n = strike.normal;
  const Matrix3 inverse = strike.rows.lazyProduct(strike.answer) + strike.inverse_mass * Matrix3::Identity();
  const double along_n = n.dot(inverse * n);
  strike.normal_mass = along_n > 0.0 ? 1.0 / along_n : 0.0;
  // Joints may leave a point no way to move along the surface: there nothing slides that could be stopped.
  const Matrix3 across = Matrix3::Identity() - n * n.transpose();
  const Matrix3 tangential = across * inverse * across;
  const double trace = tangential.trace();
  strike.tangential_mass.setZero();
  if (trace > 0.0) strike.tangential_mass = across / trace;
}

// u += M^-1 rows' J, with M^-1 rows' made once for the blow; a hand that gives way goes back by J / m.
void LinkageImpacts::Strike::push(const Vector3& on_first, LinkageProblem::Vector& velocity) {
  velocity.noalias() += answer * on_first;
  recoil += inverse_mass * on_first;
}

/// Gauss and Seidel: as much more as takes the rate to its target with the others as they are, never pulling.
double LinkageImpacts::Strike::relax_normal(LinkageProblem::Vector& velocity) {
  const double rate = normal.dot(relative_velocity(velocity));
  const double wanted = std::max(0.0, magnitude + normal_mass * (target - rate));
  const double change = wanted - magnitude;
  magnitude = wanted;
  push(change * normal, velocity);
  return normal_mass > 0.0 ? std::abs(change) / normal_mass : 0.0;
}

/// Likewise to no sliding, back to Coulomb's disc where it would leave it.
double LinkageImpacts::Strike::relax_tangential(LinkageProblem::Vector& velocity) {
  const Vector3 needed = tangential_mass * relative_velocity(velocity);
  Vector3 wanted = drag + needed;
  const double most = friction * magnitude, length = wanted.norm();
  if (length > most) wanted *= most / length;
  const Vector3 change = wanted - drag;
  drag = wanted;
  push(-change, velocity);
  return normal_mass > 0.0 ? change.norm() / normal_mass : 0.0;
}

// Eqs. 9 to 11 for all strikes at once: n.w after = -epsilon n.w before, by impulses that only push.
// Times of strikes are told but not dealt by: unlike the ImpactSolver's, blows of one step are one blow
// here.
bool LinkageImpacts::deal(const LinkageProblem& problem, bool friction, LinkageProblem::Vector& velocity) {
  velocity = problem.start();
  for (Strike& strike : strikes()) {
    prepare(problem, strike);
    strike.approach = strike.relative_velocity(velocity);
    strike.target = -strike.restitution * strike.normal.dot(strike.approach);
  }
  if (!solve(friction, velocity)) return false;
  keep_to_energy(problem, friction, velocity);
  for (const Strike& strike : strikes()) {
    if (strike.hand != nullptr) {
      strike.hand->impulse += strike.given();
      strike.hand->struck = true;
      strike.hand->time_of_impact = strike.time;
    } else if (strike.between != nullptr) {
      strike.between->impulse += strike.given();
      strike.between->struck = true;
    }
  }
  return true;
}

void LinkageImpacts::tell_limits(LinkageProblem& problem) {
  for (const Strike& strike : strikes()) {
    if (strike.joint >= 0) problem.note_blow(strike.joint, strike.magnitude * strike.rows(0, strike.joint));
  }
}

/// Finds impulses that together give every strike its velocity; false if there are none.
/// `most` is sum (1 + epsilon) |u| m_n: what each strike would need by itself.
bool LinkageImpacts::solve(bool friction, LinkageProblem::Vector& velocity) {
  double most = 0.0, scale = 0.0;
  for (const Strike& strike : strikes()) {
    const double speed = -strike.normal.dot(strike.approach);
    most += (1.0 + strike.restitution) * speed * strike.normal_mass;
    scale = std::max(scale, speed);
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double error = 0.0, sum = 0.0;
    for (Strike& strike : strikes()) {
      error = std::max(error, strike.relax_normal(velocity));
      if (friction) error = std::max(error, strike.relax_tangential(velocity));
      sum += strike.magnitude;
    }
    if (sum > kPressed * most) return false;
    if (error <= kConverged * scale) break;
  }
  return true;
}

/// As ImpactSolver's.
/// Blends two blows by one share for all strikes, and the unknowns, linear in the impulses, with them.
void LinkageImpacts::keep_to_energy(const LinkageProblem& problem, bool friction,
                                    LinkageProblem::Vector& velocity) {
  double gain = 0.0, exchanged = 0.0;
  both_.clear();
  for (const Strike& strike : strikes()) {
    const Vector3 given = strike.given(), after = strike.relative_velocity(velocity);
    both_.push_back({strike.approach, given, after, {}, {}});
    gain += energy_gained(strike.approach, given, after);
    exchanged += given.norm() * strike.approach.norm();
  }
  if (gain <= kNoGain * exchanged) return;
  velocity = problem.start();
  for (Strike& strike : strikes()) {
    strike.target = strike.magnitude = 0.0;
    strike.drag.setZero(), strike.recoil.setZero();
  }
  solve(friction, velocity);
  std::size_t i = 0;
  for (const Strike& strike : strikes()) {
    both_[i].least = strike.given();
    both_[i++].after_least = strike.relative_velocity(velocity);
  }
  keep_from_gaining(both_);
  i = 0;
  for (Strike& strike : strikes()) {
    const Vector3 more = both_[i++].newtons - strike.given();
    const double pressed = -strike.normal.dot(more);
    strike.magnitude += pressed;
    strike.drag += more + pressed * strike.normal;
    strike.push(-more, velocity);
  }
}

}  // namespace mrhi
