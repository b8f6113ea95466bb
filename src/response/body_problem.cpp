#include "body_problem.h"

#include <array>

namespace mrhi {
namespace {

/// Lower triangle of a symmetric 6 x 6 matrix that is summed up in lanes.
class LowerTriangle {
 public:
  LowerTriangle() {
    for (Lanes& entry : entries_) entry.setZero();
  }
  Lanes& at(std::size_t row, std::size_t column) { return entries_[row * (row + 1) / 2 + column]; }

  /// Adds weight w w' for w = J' f, the wrench of a force at an arm from the body's centre.
  void add_product(const Lanes& weight, const Triple<Lanes>& f, const Triple<Lanes>& arm) {
    const Triple<Lanes> torque = arm.cross(f);
    const std::array<const Lanes*, 6> w{{&f.x, &f.y, &f.z, &torque.x, &torque.y, &torque.z}};
    for (std::size_t i = 0; i < 6; ++i) {
      const Lanes weighted = weight * *w[i];
      for (std::size_t j = 0; j <= i; ++j) at(i, j) += weighted * *w[j];
    }
  }
  /// Adds J' J weight for the velocity of a point at an arm from the centre.
  void add_isotropic(const Lanes& weight, const Triple<Lanes>& r) {
    const Triple<Lanes> moment = weight * r;
    const Lanes xx = moment.x * r.x, yy = moment.y * r.y, zz = moment.z * r.z;
    for (std::size_t i = 0; i < 3; ++i) at(i, i) += weight;
    at(3, 1) -= moment.z, at(3, 2) += moment.y, at(4, 0) += moment.z;
    at(4, 2) -= moment.x, at(5, 0) -= moment.y, at(5, 1) += moment.x;
    at(3, 3) += yy + zz, at(4, 4) += xx + zz, at(5, 5) += xx + yy;
    at(4, 3) -= moment.x * r.y, at(5, 3) -= moment.x * r.z, at(5, 4) -= moment.y * r.z;
  }
  /// Adds weight n n' to the part of the angular velocity.
  void add_twist(const Lanes& weight, const Triple<Lanes>& n) {
    const Triple<Lanes> turn = weight * n;
    at(3, 3) += turn.x * n.x, at(4, 4) += turn.y * n.y, at(5, 5) += turn.z * n.z;
    at(4, 3) += turn.x * n.y, at(5, 3) += turn.x * n.z, at(5, 4) += turn.y * n.z;
  }
  void write(Eigen::Matrix<double, 6, 6>& matrix) {
    for (std::size_t i = 0; i < 6; ++i) {
      for (std::size_t j = 0; j <= i; ++j)
        matrix(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = sum(at(i, j));
    }
  }

 private:
  std::array<Lanes, 21> entries_;
};

}  // namespace

void BodyProblem::begin(const ContactStep& step, std::size_t index,
                        const std::vector<IslandContact>& contacts) {
  const Body& body = step.scene.bodies[index];
  const BodyState& state = step.bodies[index];
  contacts_ = &contacts;
  step_ = step.step;
  mass_ = body.mass;
  const Matrix3 rotation = state.pose.orientation.toRotationMatrix();
  inertia_ = rotation * body.inertia * rotation.transpose();
  gyration_squared_ = body.inertia.trace() / (3.0 * body.mass);
  start_.head<3>() = state.linear_momentum / body.mass;
  start_.tail<3>() = rotation * (body.inverse_inertia * (rotation.transpose() * state.angular_momentum));
  hessian_.setZero();
  free_ = start_;
  free_.head<3>() += step.step * step.gravity;

  fours_.resize((contacts.size() + kLanes - 1) / kLanes);
  for (std::size_t i = 0; i < kLanes * fours_.size(); ++i) {
    // A lane too many is a copy that has no stiffness.
    const bool real = i < contacts.size();
    const IslandContact& contact = contacts[real ? i : contacts.size() - 1];
    const Spring<double>& from = contact.spring;
    Four& four = fours_[i / kLanes];
    Spring<Lanes>& spring = four.spring;
    const int lane = static_cast<int>(i % kLanes);
    set_lane(lane, vector(from.normal), spring.normal);
    set_lane(lane, vector(from.stretch), spring.stretch);
    spring.depth[lane] = from.depth;
    spring.twist[lane] = from.twist;
    spring.ahead[lane] = from.ahead;
    spring.stiffness[lane] = real ? from.stiffness : 0.0;
    spring.twist_stiffness[lane] = real ? from.twist_stiffness : 0.0;
    spring.friction[lane] = from.friction;
    spring.patch_friction[lane] = from.patch_friction;
    set_lane(lane, contact.arm_b, four.arm);
    set_lane(lane, contact.drive, four.drive);
    four.drive_spin[lane] = contact.drive_spin;
  }
}

void BodyProblem::evaluate(bool renew_limits) {
  const Triple<Lanes> linear = everywhere(velocity_.head<3>()), angular = everywhere(velocity_.tail<3>());
  const Lanes zero = Lanes::Zero();
  Triple<Lanes> force{zero, zero, zero}, torque = force;
  Lanes push = zero;
  for (Four& four : fours_) {
    SpringResponse<Lanes>& response = four.response;
    const Triple<Lanes>& n = four.spring.normal;
    const Triple<Lanes> u = four.drive - linear - angular.cross(four.arm);
    four.spring.respond(u, four.drive_spin - n.dot(angular), renew_limits, response);
    force = force + response.force;
    torque = torque + four.arm.cross(response.force) + response.torque * n;
    push += response.push;
  }
  const Vector6 change = velocity_ - free_;
  gradient_.head<3>() = mass_ * change.head<3>() - step_ * sum(force);
  gradient_.tail<3>() = inertia_ * change.tail<3>() - step_ * sum(torque);
  scale_ = step_ * sum(push);
}

void BodyProblem::factorise() {
  LowerTriangle slopes;  // J' S J of the contacts' slopes S
  for (const Four& four : fours_) {
    const SpringResponse<Lanes>& response = four.response;
    const Triple<Lanes>& n = four.spring.normal;
    slopes.add_isotropic(response.along, four.arm);
    slopes.add_twist(response.torque_slope, n);
    slopes.add_product(response.across - response.along, n, four.arm);
    if (!any_above(response.slip, Lanes::Zero())) continue;
    slopes.add_product(-response.slip / greater(response.drawn_squared, constant<Lanes>(1e-300)),
                       response.drawn, four.arm);
  }
  slopes.write(hessian_);
  hessian_ *= step_;
  hessian_.diagonal().head<3>().array() += mass_;
  hessian_.bottomRightCorner<3, 3>() += inertia_;
  factors_.compute(hessian_);  // reads the lower triangle
}

double BodyProblem::error() const {
  return std::sqrt(gradient_.head<3>().squaredNorm() + gradient_.tail<3>().squaredNorm() / gyration_squared_);
}

double BodyProblem::energy() const {
  const Vector6 change = velocity_ - free_;
  double energy =
      0.5 * (mass_ * change.head<3>().squaredNorm() + change.tail<3>().dot(inertia_ * change.tail<3>()));
  for (std::size_t i = 0; i < contacts_->size(); ++i) {
    const IslandContact& contact = (*contacts_)[i];
    const Spring<Lanes>& limits = fours_[i / kLanes].spring;
    const int lane = static_cast<int>(i % kLanes);
    Spring<double> spring = contact.spring;
    spring.slip_limit = limits.slip_limit[lane];
    spring.twist_limit = limits.twist_limit[lane];
    const Vector3 u = contact.drive - velocity_.head<3>() - velocity_.tail<3>().cross(contact.arm_b);
    const double spin = contact.drive_spin - vector(spring.normal).dot(velocity_.tail<3>());
    energy += step_ * potential(spring, u, spin);
  }
  return energy;
}

void BodyProblem::finish(bool agree, std::vector<IslandContact>& contacts, BodyState& state) const {
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Four& four = fours_[i / kLanes];
    const int lane = static_cast<int>(i % kLanes);
    Spring<double>& spring = contacts[i].spring;
    spring.slip_limit = four.spring.slip_limit[lane];
    spring.twist_limit = four.spring.twist_limit[lane];
    SpringResponse<double>& response = contacts[i].response;
    response.force = triple(lane_of(lane, four.response.force));
    response.drawn = triple(lane_of(lane, four.response.drawn));
    response.push = four.response.push[lane];
    response.wanted = four.response.wanted[lane];
    response.torque = four.response.torque[lane];
  }
  state.linear_momentum = mass_ * velocity_.head<3>();
  state.angular_momentum = inertia_ * velocity_.tail<3>();
  if (!agree) return;
  state.linear_momentum -= gradient_.head<3>();
  state.angular_momentum -= gradient_.tail<3>();
}

}  // namespace mrhi
