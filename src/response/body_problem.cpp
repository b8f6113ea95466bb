#include "body_problem.h"

#include <Eigen/Cholesky>

namespace mrhi {

BodyProblem::BodyProblem(const ContactStep& step, std::size_t index, std::vector<IslandContact>& contacts)
    : contacts_(contacts), step_(step.step), mass_(step.scene.bodies[index].mass) {
  const Body& body = step.scene.bodies[index];
  const BodyState& state = step.bodies[index];
  const Matrix3 rotation = state.pose.orientation.toRotationMatrix();
  inertia_ = rotation * body.inertia * rotation.transpose();
  gyration_squared_ = body.inertia.trace() / (3.0 * body.mass);
  const Twist twist = twist_of(body, state);
  start_ << twist.linear, twist.angular;
  free_ = start_;
  free_.head<3>() += step.step * step.gravity;
}

void BodyProblem::limit_friction() {
  for (IslandContact& contact : contacts_) contact.spring.limit_friction(relative_velocity(contact));
}

void BodyProblem::assemble() {
  const Vector6 change = velocity_ - free_;
  gradient_.head<3>() = mass_ * change.head<3>();
  gradient_.tail<3>() = inertia_ * change.tail<3>();
  hessian_.setZero();
  hessian_.diagonal().head<3>().setConstant(mass_);
  hessian_.bottomRightCorner<3, 3>() = inertia_;
  scale_ = 0.0;
  for (const IslandContact& contact : contacts_) {
    const SpringContact& spring = contact.spring;
    const auto response = spring.evaluate(relative_velocity(contact), relative_spin(contact));
    if (!spring.acts(response)) continue;
    const Vector3& r = contact.arm_b;
    const Vector3& n = spring.normal;
    const auto wrench_of = [&r](const Vector3& force) {
      Vector6 wrench;
      wrench << force, r.cross(force);
      return wrench;
    };
    gradient_ -= step_ * wrench_of(response.force);
    gradient_.tail<3>() -= (step_ * response.torque) * n;
    scale_ += step_ * response.push;

    // J' S J of the slope S, isotropic part first; only the lower triangle is read.
    const double along = step_ * response.along;
    hessian_.diagonal().head<3>().array() += along;
    hessian_.bottomLeftCorner<3, 3>() += along * cross_matrix(r);
    hessian_.diagonal().tail<3>().array() += along * r.squaredNorm();
    hessian_.bottomRightCorner<3, 3>() +=
        (step_ * response.torque_slope) * n * n.transpose() - along * r * r.transpose();
    const Vector6 across = wrench_of(n);
    hessian_ += (step_ * (response.across - response.along)) * across * across.transpose();
    if (response.slip > 0.0) {
      const Vector6 sliding = wrench_of(response.direction);
      hessian_ -= (step_ * response.slip) * sliding * sliding.transpose();
    }
  }
}

double BodyProblem::error() const {
  return std::sqrt(gradient_.head<3>().squaredNorm() + gradient_.tail<3>().squaredNorm() / gyration_squared_);
}

void BodyProblem::find_direction() {
  direction_ = -hessian_.llt().solve(gradient_);
}

double BodyProblem::energy() const {
  const Vector6 change = velocity_ - free_;
  double sum =
      0.5 * (mass_ * change.head<3>().squaredNorm() + change.tail<3>().dot(inertia_ * change.tail<3>()));
  for (const IslandContact& contact : contacts_)
    sum += step_ * contact.spring.potential(relative_velocity(contact), relative_spin(contact));
  return sum;
}

void BodyProblem::finish(BodyState& state) const {
  state.linear_momentum = mass_ * velocity_.head<3>();
  state.angular_momentum = inertia_ * velocity_.tail<3>();
}

}  // namespace mrhi
