#pragma once

#include "island_contact.h"

namespace mrhi {

/// One body and what presses it, hands and fixtures: six unknowns, M (V - V*) = h sum J' f(V), whatever the
/// number of contacts. A Problem for Newton.
class BodyProblem {
 public:
  /// Keeps a reference to the contacts; each one's b is this body.
  BodyProblem(const ContactStep& step, std::size_t body, std::vector<IslandContact>& contacts);

  void restart() { velocity_ = start_; }
  void limit_friction();
  void assemble();
  double error() const;
  double scale() const { return scale_; }
  void find_direction();
  void move(double part) { velocity_ += part * direction_; }
  double energy() const;
  double descent() const { return gradient_.dot(direction_); }

  Vector3 relative_velocity(const IslandContact& contact) const {
    return contact.drive - velocity_.head<3>() - velocity_.tail<3>().cross(contact.arm_b);
  }
  double relative_spin(const IslandContact& contact) const {
    return contact.drive_spin - contact.spring.normal.dot(velocity_.tail<3>());
  }
  /// Gives the body its momenta at the step's end.
  void finish(BodyState& state) const;

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;

  std::vector<IslandContact>& contacts_;
  double step_;
  double mass_;
  double gyration_squared_;  // squared radius of gyration, by which torques count as forces [m^2]
  Matrix3 inertia_;          // world axes
  Vector6 start_, free_;     // velocity at the step's start, and at its end without contact
  Vector6 velocity_, direction_, gradient_;
  Matrix6 hessian_;
  double scale_ = 0.0;
};

}  // namespace mrhi
