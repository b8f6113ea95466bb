#include "island_problem.h"

#include <algorithm>
#include <tuple>

#include "spring_potential.h"

namespace mrhi {
namespace {

/// Larger islands are sparse: most pairs of their bodies do not touch.
constexpr std::size_t kMostDense = 12;

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;

/// J' f of a force at an arm from the body's centre.
Vector6 wrench_of(const Vector3& force, const Vector3& arm) {
  Vector6 wrench;
  wrench << force, arm.cross(force);
  return wrench;
}

/// J_x' S J_y of a contact's slope S, for the arms x and y.
Matrix6 slope_between(const IslandContact& contact, const Vector3& x, const Vector3& y) {
  const SpringResponse<double>& response = contact.response;
  const Vector3 n = vector(contact.spring.normal);
  const Matrix3 cross_x = cross_matrix(x), cross_y = cross_matrix(y);
  Matrix6 result;
  result.topLeftCorner<3, 3>() = response.along * Matrix3::Identity();
  result.topRightCorner<3, 3>() = -response.along * cross_y;
  result.bottomLeftCorner<3, 3>() = response.along * cross_x;
  result.bottomRightCorner<3, 3>() =
      response.torque_slope * n * n.transpose() - response.along * cross_x * cross_y;
  result += (response.across - response.along) * wrench_of(n, x) * wrench_of(n, y).transpose();
  if (response.slip > 0.0) {
    const Vector3 d = vector(response.drawn);
    result -= (response.slip / response.drawn_squared) * wrench_of(d, x) * wrench_of(d, y).transpose();
  }
  return result;
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

  add_contacts(step, island, configuration);
  list_blocks();
}

void IslandProblem::add_contacts(const ContactStep& step, const Island& island,
                                 const ContactConfiguration& configuration) {
  const auto number = [&](std::size_t body) {
    const auto place = std::lower_bound(island.bodies.begin(), island.bodies.end(), body,
                                        [](const IslandBody& x, std::size_t y) { return x.body < y; });
    return static_cast<int>(place - island.bodies.begin());
  };
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
  for (const Link& link : island.links) {
    const BodyContact& touch = step.body_contacts[link.index];
    const bool alone = step.scene.bodies[touch.key.a].fixed;
    add(touch, alone ? IslandContact::kAlone : number(touch.key.a), number(touch.key.b)).arm_a = touch.arm_a;
  }
}

void IslandProblem::begin_body(const Body& body, const BodyState& state, const Vector3& gravity) {
  const Eigen::Index row = 6 * static_cast<Eigen::Index>(masses_.size());
  const Matrix3 rotation = state.pose.orientation.toRotationMatrix();
  masses_.push_back(
      {body.mass, body.inertia.trace() / (3.0 * body.mass), rotation * body.inertia * rotation.transpose()});
  const Twist twist = twist_of(body, state);
  start_.segment<6>(row) << twist.linear, twist.angular;
  free_.segment<6>(row) << twist.linear + step_ * gravity, twist.angular;
  velocity_.segment<6>(row) << free_.segment<3>(row) + step_ * state.pushed.linear,
      free_.segment<3>(row + 3) + step_ * state.pushed.angular;
}

void IslandProblem::list_blocks() {
  blocks_.clear();
  for (int body = 0; body < static_cast<int>(masses_.size()); ++body) blocks_.push_back({body, body, {}});
  const auto pairs = static_cast<std::ptrdiff_t>(masses_.size());
  const auto order = [](const Block& x, const Block& y) {
    return std::tie(x.column, x.row) < std::tie(y.column, y.row);
  };
  const auto same = [](const Block& x, const Block& y) { return x.row == y.row && x.column == y.column; };
  for (const IslandContact& contact : contacts_) {
    if (contact.a == IslandContact::kAlone) continue;
    blocks_.push_back({std::max(contact.a, contact.b), std::min(contact.a, contact.b), Matrix6::Zero()});
  }
  std::sort(blocks_.begin() + pairs, blocks_.end(), order);
  blocks_.erase(std::unique(blocks_.begin() + pairs, blocks_.end(), same), blocks_.end());
  couples_.clear();
  for (const IslandContact& contact : contacts_) {
    const Block wanted{std::max(contact.a, contact.b), std::min(contact.a, contact.b), {}};
    const auto block = std::lower_bound(blocks_.begin() + pairs, blocks_.end(), wanted, order);
    couples_.push_back(static_cast<std::size_t>(block - blocks_.begin()));
  }
}

Vector3 IslandProblem::velocity_at(int body, const Vector3& arm) const {
  return velocity_.segment<3>(6 * body) + velocity_.segment<3>(6 * body + 3).cross(arm);
}

Vector3 IslandProblem::relative_velocity(const IslandContact& contact) const {
  const Vector3 of_b = velocity_at(contact.b, vector(contact.arm));
  if (contact.a == IslandContact::kAlone) return vector(contact.drive) - of_b;
  return velocity_at(contact.a, contact.arm_a) - of_b;
}

double IslandProblem::relative_spin(const IslandContact& contact) const {
  const Vector3 n = vector(contact.spring.normal);
  const double of_b = n.dot(velocity_.segment<3>(6 * contact.b + 3));
  if (contact.a == IslandContact::kAlone) return contact.drive_spin - of_b;
  return n.dot(velocity_.segment<3>(6 * contact.a + 3)) - of_b;
}

void IslandProblem::evaluate(bool renew_limits) {
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    const Vector6 change = velocity_.segment<6>(row) - free_.segment<6>(row);
    gradient_.segment<3>(row) = masses_[i].mass * change.head<3>();
    gradient_.segment<3>(row + 3) = masses_[i].inertia * change.tail<3>();
  }
  scale_ = 0.0;
  for (IslandContact& contact : contacts_) {
    SpringResponse<double>& response = contact.response;
    contact.spring.respond(triple(relative_velocity(contact)), relative_spin(contact), renew_limits,
                           response);
    scale_ += step_ * response.push;
    const Vector3 force = step_ * vector(response.force);
    const Vector3 torque = (step_ * response.torque) * vector(contact.spring.normal);
    const auto add_force = [&](int body, double sign, const Vector3& arm) {
      gradient_.segment<3>(6 * body) -= sign * force;
      gradient_.segment<3>(6 * body + 3) -= sign * (arm.cross(force) + torque);
    };
    add_force(contact.b, 1.0, vector(contact.arm));
    if (contact.a != IslandContact::kAlone) add_force(contact.a, -1.0, contact.arm_a);
  }
}

void IslandProblem::factorise() {
  for (Block& block : blocks_) block.value.setZero();
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    blocks_[i].value.diagonal().head<3>().setConstant(masses_[i].mass);
    blocks_[i].value.bottomRightCorner<3, 3>() = masses_[i].inertia;
  }
  for (std::size_t i = 0; i < contacts_.size(); ++i) {
    const IslandContact& contact = contacts_[i];
    if (contact.response.across <= 0.0 && contact.response.along <= 0.0) continue;
    const auto add_slope = [&](std::size_t block, double sign, const Vector3& x, const Vector3& y) {
      blocks_[block].value += (sign * step_) * slope_between(contact, x, y);
    };
    const Vector3 &a = contact.arm_a, b = vector(contact.arm);
    add_slope(static_cast<std::size_t>(contact.b), 1.0, b, b);
    if (contact.a == IslandContact::kAlone) continue;
    add_slope(static_cast<std::size_t>(contact.a), 1.0, a, a);
    if (contact.b > contact.a) {
      add_slope(couples_[i], -1.0, b, a);
    } else {
      add_slope(couples_[i], -1.0, a, b);
    }
  }
  if (masses_.size() > kMostDense) return factorise_sparse();
  dense_.setZero(size(), size());
  for (const Block& block : blocks_) dense_.block<6, 6>(6 * block.row, 6 * block.column) = block.value;
  dense_factors_.compute(dense_);
}

void IslandProblem::factorise_sparse() {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(36 * blocks_.size());
  for (const Block& block : blocks_) {
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column < 6; ++column)
        entries.emplace_back(6 * block.row + row, 6 * block.column + column, block.value(row, column));
    }
  }
  Eigen::SparseMatrix<double> hessian(size(), size());
  hessian.setFromTriplets(entries.begin(), entries.end());
  sparse_factors_.compute(hessian);
}

void IslandProblem::find_direction() {
  direction_ = -gradient_;
  if (masses_.size() > kMostDense) {
    direction_ = sparse_factors_.solve(direction_).eval();
  } else {
    dense_factors_.solveInPlace(direction_);
  }
}

double IslandProblem::error_squared() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    sum += gradient_.segment<3>(row).squaredNorm() +
           gradient_.segment<3>(row + 3).squaredNorm() / masses_[i].gyration_squared;
  }
  return sum;
}

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

void IslandProblem::finish(bool agree, ContactStep& step, const Island& island) const {
  Eigen::Index row = 0;
  for (std::size_t i = 0; i < masses_.size(); ++i, row += 6) {
    BodyState& state = step.bodies[island.bodies.begin()[i].body];
    state.pushed.linear = (velocity_ - free_).segment<3>(row) / step_;
    state.pushed.angular = (velocity_ - free_).segment<3>(row + 3) / step_;
    state.linear_momentum = masses_[i].mass * velocity_.segment<3>(row);
    state.angular_momentum = masses_[i].inertia * velocity_.segment<3>(row + 3);
    if (!agree) continue;
    state.linear_momentum -= gradient_.segment<3>(row);
    state.angular_momentum -= gradient_.segment<3>(row + 3);
  }
  auto contact = contacts_.begin();
  for (const IslandBody& body : island.bodies) {
    for (std::size_t i = body.first; i < body.last; ++i) {
      if (!step.contacts[i].ignored) settle(step, *contact++, step.contacts[i]);
    }
  }
  for (const Link& link : island.links) settle(step, *contact++, step.body_contacts[link.index]);
}

}  // namespace mrhi
