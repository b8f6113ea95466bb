#include "island_problem.h"

#include <algorithm>
#include <cmath>

#include "spring_contact.h"

namespace mrhi {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;

/// K = -df/du of a contact's force f against its relative velocity u, symmetric:
/// k_n n n' + k_t (1 - n n') - s d d' / d'd. The last is there where friction slips: at its limit it turns
/// with the stretch d and grows no more along it.
Matrix3 slope_at_point(const IslandContact& contact) {
  const SpringResponse& response = contact.response;
  const Vector3 n = vector(contact.spring.normal);
  Matrix3 slope = (response.normal_slope - response.tangential_slope) * n * n.transpose();
  slope.diagonal().array() += response.tangential_slope;
  if (response.slip > 0.0) {
    const Vector3 d = vector(response.drawn);
    slope -= (response.slip / response.drawn_squared * d) * d.transpose();
  }
  return slope;
}

/// The torque that a contact's force has about a body's centre, X = [x]x + t n', with the arm x of friction
/// and the tilt t.
struct Moment {
  Vector3 arm, tilt, normal;

  /// X M.
  Matrix3 of(const Matrix3& m) const {
    Matrix3 result = tilt * (normal.transpose() * m);
    for (int i = 0; i < 3; ++i) result.col(i) += arm.cross(m.col(i));
    return result;
  }
};

/// Adds J_x' S J_y, by X S and Y S; and the twist's slope. A contact moves by J_x (v, w) = v + X' w.
///
///     J_x' S J_y = (  S      S Y'     )   =   (  S      (Y S)'     )      S = S'
///                  (  X S    X S Y'   )       (  X S    X (Y S)'   )
void add(double sign, const Matrix3& slope, const Matrix3& x_slope, const Matrix3& y_slope, const Moment& x,
         const Matrix3& twist, BlockSystem::Matrix6& block) {
  block.topLeftCorner<3, 3>() += sign * slope;
  block.bottomLeftCorner<3, 3>() += sign * x_slope;
  block.topRightCorner<3, 3>() += sign * y_slope.transpose();
  block.bottomRightCorner<3, 3>() += sign * (x.of(y_slope.transpose()) + twist);
}

}  // namespace

void IslandProblem::begin(ContactStep& step, const Island& island,
                          const ContactConfiguration& configuration) {
  step_ = step.step;
  masses_.clear();
  const auto count = static_cast<Eigen::Index>(6 * island.bodies.size());
  for (Eigen::VectorXd* vector : {&start_, &free_, &velocity_, &direction_, &gradient_})
    vector->resize(count);
  for (const IslandBody& body : island.bodies)
    begin_body(step.scene.bodies[body.body], step.bodies[body.body], step.gravity);
  // Of the lightest body: what it would not be seen to move by, none of the others is.
  const auto lighter = [](const Mass& x, const Mass& y) { return x.mass < y.mass; };
  unseen_ = kUnseenWay / step_ * std::min_element(masses_.begin(), masses_.end(), lighter)->mass;

  add_contacts(step, island, configuration);
  couple();
}

void IslandProblem::add_contacts(const ContactStep& step, const Island& island,
                                 const ContactConfiguration& configuration) {
  number_.resize(step.bodies.size());
  for (std::size_t i = 0; i < island.bodies.size(); ++i)
    number_[island.bodies.first[i].body] = static_cast<int>(i);
  const auto number = [&](std::size_t body) { return number_[body]; };
  contacts_.clear();
  const auto add = [&](const auto& touch, int a, int b) -> IslandContact& {
    contacts_.emplace_back();
    make_spring(step, configuration, touch, contacts_.back());
    contacts_.back().a = a, contacts_.back().b = b;
    return contacts_.back();
  };
  for (const IslandBody& body : island.bodies) {
    for (std::size_t i = body.first; i < body.last; ++i) {
      if (!step.contacts[i].ignored) add(step.contacts[i], IslandContact::kAlone, number(body.body));
    }
  }
  for (const IslandBody& body : island.bodies) {
    for (const Grip& grip : step.grips) {
      if (!grip.active || grip.body != body.body) continue;
      for (int point = 0; point < kGripPoints; ++point) {
        contacts_.emplace_back();
        make_grip_spring(step, configuration, grip, point, contacts_.back());
        contacts_.back().a = IslandContact::kAlone, contacts_.back().b = number(body.body);
      }
    }
  }
  for (const Link& link : island.links) {
    const BodyContact& touch = step.body_contacts[link.index];
    const bool alone = step.scene.bodies[touch.key.a].fixed;
    add(touch, alone ? IslandContact::kAlone : number(touch.key.a), number(touch.key.b)).arm_a =
        touch.arm_a + touch.friction_offset;
  }
}

// u* = (p / m + h g, I^-1 L), and no gyroscopic term: as of BodyProblem.
void IslandProblem::begin_body(const Body& body, const BodyState& state, const Vector3& gravity) {
  const Eigen::Index row = 6 * static_cast<Eigen::Index>(masses_.size());
  const Matrix3 rotation = state.pose.orientation.toRotationMatrix();
  masses_.push_back(
      {body.mass, body.inertia.trace() / (3.0 * body.mass), rotation * body.inertia * rotation.transpose()});
  // Newton's method begins where gravity and what acted in the last step would bring the body.
  const Twist twist = twist_of(body, state);
  start_.segment<6>(row) << twist.linear, twist.angular;
  free_.segment<6>(row) << twist.linear + step_ * gravity, twist.angular;
  velocity_.segment<6>(row) << free_.segment<3>(row) + step_ * state.pushed.linear,
      free_.segment<3>(row + 3) + step_ * state.pushed.angular;
}

/// Which blocks of six by six the Hessian has beside its diagonal: one for each pair that touches.
void IslandProblem::couple() {
  system_.begin(static_cast<int>(masses_.size()));
  // The contacts of a pair follow each other, and the pairs' bodies come in order, as the island's do.
  for (IslandContact& contact : contacts_) {
    if (contact.a != IslandContact::kAlone) contact.coupling = system_.couple(contact.a, contact.b);
  }
}

Effort IslandProblem::effort() {
  Effort effort;
  effort.iterations = 6;  // what settles does so in one or two
  effort.limits = 0;
  effort.anew = false;
  return effort;
}

Vector3 IslandProblem::relative_velocity(const IslandContact& contact) const {
  const auto velocity = [&](int body) { return velocity_.segment<3>(6 * body); };
  const auto spin = [&](int body) { return velocity_.segment<3>(6 * body + 3); };
  const Vector3 u = vector(contact.relative_velocity(triple(velocity(contact.b)), triple(spin(contact.b))));
  if (contact.a == IslandContact::kAlone) return u;
  const Vector3 w = spin(contact.a);
  return u + velocity(contact.a) + w.cross(contact.arm_a) +
         w.dot(vector(contact.tilt)) * vector(contact.spring.normal);
}

double IslandProblem::relative_spin(const IslandContact& contact) const {
  const Vector3 n = vector(contact.spring.normal);
  const double of_b = n.dot(velocity_.segment<3>(6 * contact.b + 3));
  if (contact.a == IslandContact::kAlone) return contact.drive_spin - of_b;
  return n.dot(velocity_.segment<3>(6 * contact.a + 3)) - of_b;
}

/// As most contacts of a crowd that may touch do: it then gives nothing, as respond() would find.
/// d+ = d - tau u.n <= 0, in a form without the spring's other work. Two things forbid the short cut: a
/// bond, which pulls without any push, and limits that are held, by which friction acts on though the push
/// is gone.
bool IslandProblem::stays_apart(IslandContact& contact, const Triple& u, bool renew_limits) {
  Spring& spring = contact.spring;
  if (spring.bond > 0.0 || spring.depth > spring.ahead * u.dot(spring.normal)) return false;
  if (!renew_limits && (spring.slip_limit > 0.0 || spring.twist_limit > 0.0)) return false;
  spring.slip_limit = spring.twist_limit = 0.0;
  contact.response = {};
  return true;
}

/// Backward Euler: M (u - u*) = h sum J' f(J u), where u* is the motion without contacts. The gradient is the
/// impulse that the two sides differ by. It is that of energy() too, as long as friction's limits are held.
/// With u_c = J_a U_a - J_b U_b and f on b, -f on a:
///
///     g_b = M_b (U_b - U_b*) - h sum (f, b x f + T n),     g_a = M_a (U_a - U_a*) + h sum (f, a x f + T n)
///
/// Contacts between bodies cancel in the sum of g over the bodies, so that finish(), which takes g off M U,
/// keeps momentum to rounding however large g is.
void IslandProblem::evaluate(bool renew_limits) {
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    const Vector6 change = velocity_.segment<6>(row) - free_.segment<6>(row);
    gradient_.segment<3>(row) = masses_[i].mass * change.head<3>();
    gradient_.segment<3>(row + 3) = masses_[i].inertia * change.tail<3>();
  }
  scale_ = 0.0;
  for (IslandContact& contact : contacts_) {
    SpringResponse& response = contact.response;
    const Triple u = triple(relative_velocity(contact));
    if (stays_apart(contact, u, renew_limits)) continue;
    contact.spring.respond(u, relative_spin(contact), renew_limits, response);
    scale_ += step_ * (response.push + contact.spring.bond);
    const Vector3 force = step_ * vector(response.force);
    const Vector3 n = vector(contact.spring.normal);
    const Vector3 torque = (step_ * response.torque) * n + force.dot(n) * vector(contact.tilt);
    const auto add_force = [&](int body, double sign, const Vector3& arm) {
      gradient_.segment<3>(6 * body) -= sign * force;
      gradient_.segment<3>(6 * body + 3) -= sign * (arm.cross(force) + torque);
    };
    add_force(contact.b, 1.0, vector(contact.arm));
    if (contact.a != IslandContact::kAlone) add_force(contact.a, -1.0, contact.arm_a);
  }
}

void IslandProblem::factorise() {
  assemble();
  system_.factorise();
}

/// H = M + h sum J' K J: positive definite, as no spring's K has a negative eigenvalue.
/// M is block diagonal; a contact adds to the blocks of its two bodies, and K's opposite between them.
void IslandProblem::assemble() {
  system_.clear();
  for (int i = 0; i < static_cast<int>(masses_.size()); ++i) {
    const Mass& mass = masses_[static_cast<std::size_t>(i)];
    system_.diagonal(i).diagonal().head<3>().setConstant(mass.mass);
    system_.diagonal(i).bottomRightCorner<3, 3>() = mass.inertia;
  }
  for (const IslandContact& contact : contacts_) {
    if (contact.response.normal_slope > 0.0 || contact.response.tangential_slope > 0.0) add_slope(contact);
  }
}

void IslandProblem::start_from(const Eigen::VectorXd& start, const Eigen::VectorXd& free) {
  start_ = start;
  free_ = free;
}

void IslandProblem::multiply_hessian(const Eigen::MatrixXd& by, Eigen::MatrixXd& result) {
  assemble();
  system_.multiply(by, result);
}

// H_aa += h J_a' K J_a,  H_bb += h J_b' K J_b,  H_ba -= h J_b' K J_a, of which the system keeps the one
// below the diagonal: rows of the later body.
void IslandProblem::add_slope(const IslandContact& contact) {
  const Matrix3 slope = step_ * slope_at_point(contact);
  const Vector3 n = vector(contact.spring.normal), tilt = vector(contact.tilt);
  const Moment b{vector(contact.arm), tilt, n}, a{contact.arm_a, tilt, n};
  const Matrix3 twist = (step_ * contact.response.torque_slope) * n * n.transpose();
  const Matrix3 b_slope = b.of(slope);
  add(1.0, slope, b_slope, b_slope, b, twist, system_.diagonal(contact.b));
  if (contact.a == IslandContact::kAlone) return;
  const Matrix3 a_slope = a.of(slope);
  add(1.0, slope, a_slope, a_slope, a, twist, system_.diagonal(contact.a));
  add(-1.0, slope, b_slope, a_slope, b, twist, system_.between(contact.coupling));
}

/// In N s: an angular impulse counts as the impulse that gives it at the radius of gyration.
/// k^2 = tr I / 3m, the mean over the axes.
double IslandProblem::error_squared() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    sum += gradient_.segment<3>(row).squaredNorm() +
           gradient_.segment<3>(row + 3).squaredNorm() / masses_[i].gyration_squared;
  }
  return sum;
}

/// (u - u*)' M (u - u*) / 2 + h sum V(J u), with V the potential whose slope is -f: convex, least at the
/// step's solution (Kane, Marsden, Ortiz & West, Variational integrators, IJNME 49, 2000).
double IslandProblem::energy() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    const Vector6 change = velocity_.segment<6>(row) - free_.segment<6>(row);
    sum += 0.5 * (masses_[i].mass * change.head<3>().squaredNorm() +
                  change.tail<3>().dot(masses_[i].inertia * change.tail<3>()));
  }
  for (const IslandContact& contact : contacts_)
    sum += step_ * potential(contact.spring, triple(relative_velocity(contact)), relative_spin(contact));
  return sum;
}

bool IslandProblem::nearly_agree() const {
  return error_squared() <= kNearlyAgree * kNearlyAgree * scale_ * scale_;
}

void IslandProblem::finish(ContactStep& step, const Island& island) {
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < masses_.size(); ++i, row += 6) {
    BodyState& state = step.bodies[island.bodies.begin()[i].body];
    state.pushed.linear = (velocity_ - free_).segment<3>(row) / step_;
    state.pushed.angular = (velocity_ - free_).segment<3>(row + 3) / step_;
    // M u less the gradient is M u* + h sum J' f: what one body gains another loses, however far u is solved.
    state.linear_momentum = masses_[i].mass * velocity_.segment<3>(row);
    state.angular_momentum = masses_[i].inertia * velocity_.segment<3>(row + 3);
    state.linear_momentum -= gradient_.segment<3>(row);
    state.angular_momentum -= gradient_.segment<3>(row + 3);
  }
  settle_touches(step, island);
}

void IslandProblem::settle_touches(ContactStep& step, const Island& island) {
  auto contact = settle_hands(step, island, contacts_.begin());
  for (const Link& link : island.links) settle(step, *contact++, step.body_contacts[link.index]);
}

}  // namespace mrhi
