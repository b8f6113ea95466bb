#pragma once

#include <vector>

#include "block_system.h"
#include "islands.h"
#include "newton.h"
#include "spring_contact.h"
#include "spring_lanes.h"

namespace mrhi {

/// One body and what presses it, hands and fixtures: six unknowns, M (V - V*) = h sum J' f(V), whatever the
/// number of contacts. A Problem for Newton. Contacts are worked on four at a time.
class BodyProblem {
 public:
  static constexpr bool kTrustsLastStep = true;  // nothing shares momentum with the body

  BodyProblem();
  void begin(ContactStep& step, const Island& island, const ContactConfiguration& configuration);

  static Effort effort() { return {}; }
  void restart() { velocity_ = start_; }
  void evaluate(bool renew_limits);
  double error_squared() const;
  double scale() const { return step_ * sum_.push; }
  double unseen() const { return unseen_; }
  void factorise();
  void find_direction() { direction_ = factors_.solve(-gradient_); }
  void move(double part) { velocity_ += part * direction_; }
  Twist velocity() const { return {velocity_.head<3>(), velocity_.tail<3>()}; }
  double energy() const;
  double descent() const { return gradient_.dot(direction_); }

  /// Gives the contacts what they have become, and the body its momenta at the step's end: what the forces
  /// make of it where these and the velocity `agree`.
  void finish(bool agree, ContactStep& step, const Island& island) const;

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  void begin_body(const Body& body, const BodyState& state, const Vector3& gravity);

  const SpringLanes& lanes_ = spring_lanes();
  // What presses the body, filled up to fours, and all of it as springs.
  std::vector<Contact*> hands_;
  std::vector<BodyContact*> objects_;
  std::vector<Grip*> grips_;
  std::vector<SpringContact<Lanes>> springs_;
  Contact no_contact_;
  BodyContact no_body_contact_;

  double step_ = 0.0, mass_ = 0.0;
  double unseen_ = 0.0;
  double gyration_squared_ = 0.0;  // squared radius of gyration, by which torques count as forces [m^2]
  Matrix3 inertia_;                // world axes
  Vector6 start_, free_;           // velocity at the step's start, and at its end without contact
  Vector6 velocity_, direction_, gradient_;
  SpringSum sum_;
  Cholesky6 factors_;
};

}  // namespace mrhi
