#pragma once

#include <vector>

#include "block_system.h"
#include "islands.h"
#include "newton.h"
#include "spring_contact.h"

namespace mrhi {

/// Of the bodies of an island, which are numbered from 0: body 2 is number `b`, body 1 number `a` or, moving
/// by itself, none of them.
struct IslandContact : SpringContact {
  static constexpr int kAlone = -1;
  int a, b;
  Vector3 arm_a;         // of friction, from the centre of a [m]
  std::size_t coupling;  // of a and b in the system
};

/// A few bodies that touch each other, and what presses them: six unknowns a body, solved together. A
/// Problem for Newton. Keeps its memory from island to island.
class IslandProblem {
 public:
  static constexpr bool kTrustsLastStep = false;  // momentum is conserved between the bodies

  void begin(ContactStep& step, const Island& island, const ContactConfiguration& configuration);

  /// What does not settle by then goes on as a crowd.
  static Effort effort();
  void restart() { velocity_ = start_; }
  void evaluate(bool renew_limits);
  double error_squared() const;
  double scale() const { return scale_; }
  double unseen() const { return unseen_; }
  void factorise();
  void find_direction() {
    direction_ = -gradient_;
    system_.solve(direction_);
  }
  void move(double part) { velocity_ += part * direction_; }
  double energy() const;
  double descent() const { return gradient_.dot(direction_); }

  // For bodies whose velocities depend on fewer unknowns (linkage_problem.h).
  /// Starts from these velocities in place of the bodies' own; `free` is what is reached without contact.
  void start_from(const Eigen::VectorXd& start, const Eigen::VectorXd& free);
  void set_velocity(const Eigen::VectorXd& velocity) { velocity_ = velocity; }
  /// Impulse that is missing at the last velocity evaluated, and its slope there.
  const Eigen::VectorXd& gradient() const { return gradient_; }
  /// The Hessian times another matrix.
  void multiply_hessian(const Eigen::MatrixXd& by, Eigen::MatrixXd& result);
  /// Gives the contacts what they have become.
  void settle_touches(ContactStep& step, const Island& island);

  /// Whether so little is missing that momenta may be what the forces make of them.
  bool nearly_agree() const;
  /// Gives the contacts what they have become, and the bodies their momenta at the step's end: what the
  /// forces make of them, so that none is lost between bodies.
  void finish(ContactStep& step, const Island& island);

 private:
  /// Where less than this is missing, momenta are what the forces make of them; of the forces' impulse.
  static constexpr double kNearlyAgree = 1e-4;

  using Vector6 = Eigen::Matrix<double, 6, 1>;
  struct Mass {
    double mass;
    double gyration_squared;  // [m^2]
    Matrix3 inertia;          // world axes
  };
  Vector3 relative_velocity(const IslandContact& contact) const;
  double relative_spin(const IslandContact& contact) const;
  void begin_body(const Body& body, const BodyState& state, const Vector3& gravity);
  void add_contacts(const ContactStep& step, const Island& island, const ContactConfiguration& configuration);
  void couple();
  void add_slope(const IslandContact& contact);
  void assemble();
  static bool stays_apart(IslandContact& contact, const Triple& u, bool renew_limits);

  std::vector<IslandContact> contacts_;
  double step_ = 0.0;
  std::vector<Mass> masses_;
  Eigen::VectorXd start_, free_, velocity_, direction_, gradient_;
  BlockSystem system_;
  double scale_ = 0.0, unseen_ = 0.0;
  std::vector<int> number_;  // of each of the scene's bodies in the island
};

}  // namespace mrhi
