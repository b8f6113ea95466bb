#include "linkage_impacts.h"

#include <algorithm>

#include "impact.h"
#include "mr_hand_interaction/collision/god_object.h"

namespace mrhi {
namespace {

constexpr int kSweeps = 500;
constexpr double kConverged = 1e-13;  // of the approach velocity
/// Impulses that grow beyond this multiple of what the blow needs have no end.
constexpr double kPressed = 4.0;

/// Velocity of a body's point by the unknowns, times `sign`, added.
void add_point_rows(const LinkageProblem& problem, int place, const Vector3& arm, double sign,
                    Eigen::Matrix<double, 3, Eigen::Dynamic>& rows) {
  const auto linear = problem.jacobian().middleRows<3>(6 * place);
  const auto angular = problem.jacobian().middleRows<3>(6 * place + 3);
  rows += sign * linear - (sign * cross_matrix(arm)).lazyProduct(angular);
}

int place_in(const Island& island, std::size_t body) {
  const auto found = std::lower_bound(island.bodies.begin(), island.bodies.end(), body,
                                      [](const IslandBody& x, std::size_t y) { return x.body < y; });
  return static_cast<int>(found - island.bodies.begin());
}

}  // namespace

bool LinkageImpacts::find(ContactStep& step, const Island& island, const LinkageProblem& problem) {
  count_ = 0;
  const auto material = [&](std::size_t body) -> const Material& { return step.scene.bodies[body].material; };
  for (const IslandBody& body : island.bodies) {
    const int place = place_in(island, body.body);
    for (std::size_t i = body.first; i < body.last; ++i) {
      Contact& contact = step.contacts[i];
      if (contact.ignored || contact.struck) continue;
      Strike& strike = next();
      strike.hand = &contact;
      strike.normal = contact.normal, strike.drive = contact.hand_velocity;
      strike.gap = -contact.depth;
      strike.restitution = material(body.body).restitution;
      strike.friction = material(body.body).static_friction;
      strike.inverse_mass = contact.inverse_mass;
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
    add_point_rows(problem, place_in(island, contact.key.b), contact.arm_b, -1.0, strike.rows);
    if (!step.scene.bodies[contact.key.a].fixed)
      add_point_rows(problem, place_in(island, contact.key.a), contact.arm_a, 1.0, strike.rows);
    add(step.step, problem);
  }
  return count_ > 0;
}

LinkageImpacts::Strike& LinkageImpacts::next() {
  if (count_ == strikes_.size()) strikes_.emplace_back();
  Strike& strike = strikes_[count_];
  strike.hand = nullptr, strike.between = nullptr;
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

void LinkageImpacts::Strike::push(const Vector3& on_first, LinkageProblem::Vector& velocity) {
  velocity.noalias() += answer * on_first;
  recoil += inverse_mass * on_first;
}

double LinkageImpacts::Strike::relax_normal(LinkageProblem::Vector& velocity) {
  const double rate = normal.dot(relative_velocity(velocity));
  const double wanted = std::max(0.0, magnitude + normal_mass * (target - rate));
  const double change = wanted - magnitude;
  magnitude = wanted;
  push(change * normal, velocity);
  return normal_mass > 0.0 ? std::abs(change) / normal_mass : 0.0;
}

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

bool LinkageImpacts::deal(const LinkageProblem& problem, bool friction, LinkageProblem::Vector& velocity) {
  velocity = problem.start();
  double most = 0.0, scale = 0.0;
  for (Strike& strike : now()) {
    prepare(problem, strike);
    const double speed = strike.normal.dot(strike.relative_velocity(velocity));
    strike.target = -strike.restitution * speed;
    most += -(1.0 + strike.restitution) * speed * strike.normal_mass;
    scale = std::max(scale, -speed);
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    double error = 0.0, sum = 0.0;
    for (Strike& strike : now()) {
      error = std::max(error, strike.relax_normal(velocity));
      if (friction) error = std::max(error, strike.relax_tangential(velocity));
      sum += strike.magnitude;
    }
    if (sum > kPressed * most) return false;
    if (error <= kConverged * scale) break;
  }
  for (Strike& strike : now()) {
    const Vector3 given = strike.drag - strike.magnitude * strike.normal;
    if (strike.hand != nullptr) {
      strike.hand->impulse += given;
      strike.hand->struck = true;
      strike.hand->time_of_impact = strike.time;
    } else {
      strike.between->impulse += given;
      strike.between->struck = true;
    }
  }
  return true;
}

}  // namespace mrhi
