#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "island_contact.h"

namespace mrhi {

/// One body and what presses it, hands and fixtures: six unknowns, M (V - V*) = h sum J' f(V), whatever the
/// number of contacts. A Problem for Newton. Contacts are worked on four at a time.
class BodyProblem {
 public:
  static constexpr bool kTrustsLastStep = true;  // nothing shares momentum with the body

  /// Each contact's b is this body.
  void begin(const ContactStep& step, std::size_t body, const std::vector<IslandContact>& contacts);

  void restart() { velocity_ = start_; }
  void evaluate(bool renew_limits);
  double error() const;
  double scale() const { return scale_; }
  void factorise();
  void find_direction() { direction_ = -factors_.solve(gradient_); }
  void move(double part) { velocity_ += part * direction_; }
  double energy() const;
  double descent() const { return gradient_.dot(direction_); }

  /// Gives the contacts their last responses and limits, and the body its momenta at the step's end: what the
  /// forces make of it where these and the velocity `agree`.
  void finish(bool agree, std::vector<IslandContact>& contacts, BodyState& state) const;

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  struct Four {
    Spring<Lanes> spring;
    SpringResponse<Lanes> response;
    Triple<Lanes> arm, drive;
    Lanes drive_spin;
  };

  const std::vector<IslandContact>* contacts_ = nullptr;
  std::vector<Four> fours_;
  double step_ = 0.0, mass_ = 0.0;
  double gyration_squared_ = 0.0;  // squared radius of gyration, by which torques count as forces [m^2]
  Matrix3 inertia_;                // world axes
  Vector6 start_, free_;           // velocity at the step's start, and at its end without contact
  Vector6 velocity_, direction_, gradient_;
  Matrix6 hessian_;
  Eigen::LLT<Matrix6> factors_;
  double scale_ = 0.0;
};

}  // namespace mrhi
