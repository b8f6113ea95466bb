#pragma once

#include <vector>

#include "block_system.h"
#include "islands.h"
#include "newton.h"
#include "spring_contact.h"

namespace mrhi {

/// A spring of a body, and which of the partial sums below it belongs to.
/// Sums over springs are four partial ones, which do not wait for each other, added up in a fixed order: a
/// sum of floating-point numbers depends on its order.
struct BodySpring : SpringContact {
  int part;  // 0..3
};
constexpr int kParts = 4;

/// What springs do to a body together.
struct SpringSum {
  Triple force;   ///< [N]
  Triple torque;  ///< about the body's centre [N m]
  double push;    ///< sum of the pushes' sizes, and of the bonds' [N]
};
/// Lets each spring respond at the body's velocity and angular velocity.
SpringSum respond(Triple velocity, Triple spin, bool renew_limits, std::vector<BodySpring>& springs);

/// -d (force, torque) / d (velocity, angular velocity) of the body, by the last responses: the lower
/// triangle, row by row.
struct SpringSlope {
  double entry[Cholesky6::kEntries];
};
SpringSlope slope_of(const std::vector<BodySpring>& springs);

/// One body and what presses it, hands and fixtures: six unknowns, M (V - V*) = h sum J' f(V), whatever the
/// number of contacts. A Problem for Newton.
class BodyProblem {
 public:
  static constexpr bool kTrustsLastStep = true;  // nothing shares momentum with the body

  void begin(ContactStep& step, const Island& island, const ContactConfiguration& configuration);

  /// The body of an operator whose hands touch fixtures. The operator moves against the fixtures as a body
  /// moves against hands, with the opposite velocity and momenta: these are the ones solved for. `contacts`
  /// are with fixtures, sorted by key; hands are carried with `carrier`.
  void begin_operator(ContactStep& step, std::size_t body, const std::vector<Contact*>& contacts,
                      const Twist& carrier, const ContactConfiguration& configuration);
  /// Gives the contacts what they have become, and the operator the momenta at the step's end.
  void finish_operator(bool agree, ContactStep& step, std::size_t body);

  static Effort effort() { return {}; }
  void restart() { velocity_ = start_; }
  void evaluate(bool renew_limits);
  double error_squared() const;
  double scale() const { return step_ * sum_.push; }
  double unseen() const { return unseen_; }
  void factorise();
  void find_direction() { direction_ = factors_.solve(-gradient_); }
  void move(double part) { velocity_ += part * direction_; }
  /// Of the body; of one that is coupled to an operator as seen from where the operator was going.
  Twist velocity() const {
    if (!coupled_) return {velocity_.head<3>(), velocity_.tail<3>()};
    return {velocity_.head<3>() + carrier_.linear, velocity_.tail<3>() + carrier_.angular};
  }
  double energy() const;
  double descent() const { return gradient_.dot(direction_); }

  /// Gives the contacts what they have become, and the body its momenta at the step's end: what the forces
  /// make of it where these and the velocity `agree`.
  void finish(bool agree, ContactStep& step, const Island& island) const;

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;

  using Matrix6 = BlockSystem::Matrix6;

  template <typename Contacts>
  static void make_springs(const ContactStep& step, const ContactConfiguration& configuration,
                           const Contacts& contacts, BodySpring* spring);
  void begin_body(const Body& body, const BodyState& state, const Vector3& gravity);
  int sole_operator(const ContactStep& step) const;
  void couple(const ContactStep& step, const Body& body, const BodyState& state, std::size_t op);
  void finish_body(bool agree, BodyState& state) const;

  // What presses the body, and all of it as springs in this order.
  std::vector<Contact*> hands_;
  std::vector<BodyContact*> objects_;
  std::vector<Grip*> grips_;
  std::vector<BodySpring> springs_;

  double step_ = 0.0, mass_ = 0.0;
  double unseen_ = 0.0;
  double gyration_squared_ = 0.0;  // squared radius of gyration, by which torques count as forces [m^2]
  Matrix3 inertia_;                // world axes
  Vector6 start_, free_;           // velocity at the step's start, and at its end without contact
  Vector6 velocity_, direction_, gradient_;
  SpringSum sum_;
  bool coupled_ =
      false;  ///< to the operator whose hands press the body: velocities are those against the operator
  Matrix6 reduced_;  ///< mass of body and operator against each other
  Twist carrier_;    ///< of the operator, at the body's centre
  Vector3 gravity_;
  Cholesky6 factors_;
};

}  // namespace mrhi
