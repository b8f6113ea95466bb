#include "island_problem.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <tuple>

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

/// J_x' S J_y of the slope S = along 1, for the arms x and y.
Matrix6 isotropic(double along, const Vector3& x, const Vector3& y) {
  Matrix6 result;
  const Matrix3 cross_x = cross_matrix(x), cross_y = cross_matrix(y);
  result.topLeftCorner<3, 3>() = along * Matrix3::Identity();
  result.topRightCorner<3, 3>() = -along * cross_y;
  result.bottomLeftCorner<3, 3>() = along * cross_x;
  result.bottomRightCorner<3, 3>() = -along * cross_x * cross_y;
  return result;
}

/// J_x' S J_y of a contact's whole slope.
Matrix6 slope_between(const SpringContact& spring, const SpringContact::Response& response, const Vector3& x,
                      const Vector3& y) {
  const Vector3& n = spring.normal;
  Matrix6 result = isotropic(response.along, x, y);
  result += (response.across - response.along) * wrench_of(n, x) * wrench_of(n, y).transpose();
  if (response.slip > 0.0) {
    const Vector3& d = response.direction;
    result -= response.slip * wrench_of(d, x) * wrench_of(d, y).transpose();
  }
  result.bottomRightCorner<3, 3>() += response.torque_slope * n * n.transpose();
  return result;
}

}  // namespace

void IslandProblem::begin(const ContactStep& step, const std::vector<int>& bodies,
                          std::vector<IslandContact>& contacts) {
  contacts_ = &contacts;
  step_ = step.step;
  masses_.clear();
  const auto count = static_cast<Eigen::Index>(6 * bodies.size());
  for (Eigen::VectorXd* vector : {&start_, &free_, &velocity_, &direction_, &gradient_})
    vector->resize(count);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const auto index = static_cast<std::size_t>(bodies[i]);
    const Body& body = step.scene.bodies[index];
    const BodyState& state = step.bodies[index];
    const Matrix3 rotation = state.pose.orientation.toRotationMatrix();
    masses_.push_back({body.mass, body.inertia.trace() / (3.0 * body.mass),
                       rotation * body.inertia * rotation.transpose()});
    const Twist twist = twist_of(body, state);
    start_.segment<6>(static_cast<Eigen::Index>(6 * i)) << twist.linear, twist.angular;
    free_.segment<6>(static_cast<Eigen::Index>(6 * i)) << twist.linear + step.step * step.gravity,
        twist.angular;
  }
  list_blocks();
}

void IslandProblem::list_blocks() {
  blocks_.clear();
  const auto order = [](const Block& x, const Block& y) {
    return std::tie(x.column, x.row) < std::tie(y.column, y.row);
  };
  const auto same = [](const Block& x, const Block& y) { return x.row == y.row && x.column == y.column; };
  for (const IslandContact& contact : *contacts_) {
    if (contact.a == IslandContact::kAlone) continue;
    blocks_.push_back({std::max(contact.a, contact.b), std::min(contact.a, contact.b), Matrix6::Zero()});
  }
  std::sort(blocks_.begin(), blocks_.end(), order);
  blocks_.erase(std::unique(blocks_.begin(), blocks_.end(), same), blocks_.end());
  couples_.clear();
  for (const IslandContact& contact : *contacts_) {
    const Block wanted{std::max(contact.a, contact.b), std::min(contact.a, contact.b), {}};
    const auto block = std::lower_bound(blocks_.begin(), blocks_.end(), wanted, order);
    couples_.push_back(masses_.size() + static_cast<std::size_t>(block - blocks_.begin()));
  }
  std::vector<Block> diagonal;
  for (int body = 0; body < static_cast<int>(masses_.size()); ++body)
    diagonal.push_back({body, body, Matrix6::Zero()});
  blocks_.insert(blocks_.begin(), diagonal.begin(), diagonal.end());
}

Vector3 IslandProblem::velocity_at(int body, const Vector3& arm) const {
  return velocity_.segment<3>(6 * body) + velocity_.segment<3>(6 * body + 3).cross(arm);
}

Vector3 IslandProblem::relative_velocity(const IslandContact& contact) const {
  const Vector3 of_b = velocity_at(contact.b, contact.arm_b);
  if (contact.a == IslandContact::kAlone) return contact.drive - of_b;
  return velocity_at(contact.a, contact.arm_a) - of_b;
}

double IslandProblem::relative_spin(const IslandContact& contact) const {
  const Vector3& n = contact.spring.normal;
  const double of_b = n.dot(velocity_.segment<3>(6 * contact.b + 3));
  if (contact.a == IslandContact::kAlone) return contact.drive_spin - of_b;
  return n.dot(velocity_.segment<3>(6 * contact.a + 3)) - of_b;
}

void IslandProblem::limit_friction() {
  for (IslandContact& contact : *contacts_) contact.spring.limit_friction(relative_velocity(contact));
}

void IslandProblem::assemble() {
  for (Block& block : blocks_) block.value.setZero();
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    const Vector6 change = velocity_.segment<6>(row) - free_.segment<6>(row);
    gradient_.segment<3>(row) = masses_[i].mass * change.head<3>();
    gradient_.segment<3>(row + 3) = masses_[i].inertia * change.tail<3>();
    blocks_[i].value.diagonal().head<3>().setConstant(masses_[i].mass);
    blocks_[i].value.bottomRightCorner<3, 3>() = masses_[i].inertia;
  }
  scale_ = 0.0;
  for (std::size_t i = 0; i < contacts_->size(); ++i) {
    const IslandContact& contact = (*contacts_)[i];
    const auto response = contact.spring.evaluate(relative_velocity(contact), relative_spin(contact));
    if (!contact.spring.acts(response)) continue;
    scale_ += step_ * response.push;
    const auto add_force = [&](int body, double sign, const Vector3& arm) {
      Vector6 wrench = wrench_of(response.force, arm);
      wrench.tail<3>() += response.torque * contact.spring.normal;
      gradient_.segment<6>(6 * body) -= (sign * step_) * wrench;
      blocks_[static_cast<std::size_t>(body)].value +=
          step_ * slope_between(contact.spring, response, arm, arm);
    };
    add_force(contact.b, 1.0, contact.arm_b);
    if (contact.a == IslandContact::kAlone) continue;
    add_force(contact.a, -1.0, contact.arm_a);
    const bool b_below = contact.b > contact.a;
    blocks_[couples_[i]].value -=
        step_ * slope_between(contact.spring, response, b_below ? contact.arm_b : contact.arm_a,
                              b_below ? contact.arm_a : contact.arm_b);
  }
}

double IslandProblem::error() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    sum += gradient_.segment<3>(row).squaredNorm() +
           gradient_.segment<3>(row + 3).squaredNorm() / masses_[i].gyration_squared;
  }
  return std::sqrt(sum);
}

void IslandProblem::find_direction() {
  if (masses_.size() <= kMostDense) {
    find_direction_dense();
  } else {
    find_direction_sparse();
  }
}

void IslandProblem::find_direction_dense() {
  dense_.setZero(size(), size());
  for (const Block& block : blocks_) dense_.block<6, 6>(6 * block.row, 6 * block.column) = block.value;
  Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> factors(dense_);
  direction_ = -gradient_;
  factors.solveInPlace(direction_);
}

void IslandProblem::find_direction_sparse() {
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
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factors(hessian);
  direction_ = factors.solve(-gradient_);
}

double IslandProblem::energy() const {
  double sum = 0.0;
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    const auto row = static_cast<Eigen::Index>(6 * i);
    const Vector6 change = velocity_.segment<6>(row) - free_.segment<6>(row);
    sum += 0.5 * (masses_[i].mass * change.head<3>().squaredNorm() +
                  change.tail<3>().dot(masses_[i].inertia * change.tail<3>()));
  }
  for (const IslandContact& contact : *contacts_)
    sum += step_ * contact.spring.potential(relative_velocity(contact), relative_spin(contact));
  return sum;
}

void IslandProblem::finish(const std::vector<int>& bodies, std::vector<BodyState>& states) const {
  for (std::size_t i = 0; i < masses_.size(); ++i) {
    BodyState& state = states[static_cast<std::size_t>(bodies[i])];
    const auto row = static_cast<Eigen::Index>(6 * i);
    state.linear_momentum = masses_[i].mass * velocity_.segment<3>(row);
    state.angular_momentum = masses_[i].inertia * velocity_.segment<3>(row + 3);
  }
}

}  // namespace mrhi
