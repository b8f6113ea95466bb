#pragma once

#include <limits>
#include <vector>

#include "../joints/joint_law.h"
#include "../joints/linkage.h"
#include "island_problem.h"

namespace mrhi {

/// An island in which bodies hang on joints: the unknowns are the joints' velocities, and six of each body
/// that is free, M (u - u*) = h (J' sum f(J u) + sum of what joints give by themselves). A Problem for
/// Newton. What contacts are to bodies is the IslandProblem's; J makes of it what they are to joints, which
/// so cannot come apart.
class LinkageProblem {
 public:
  static constexpr bool kTrustsLastStep = false;
  explicit LinkageProblem(double usual_step) : usual_(usual_step) {}

  using Vector = Eigen::VectorXd;
  using Matrix = Eigen::MatrixXd;

  /// `linkages`: all of the scene, with their motions placed where they are.
  void begin(ContactStep& step, const Island& island, const ContactConfiguration& configuration,
             const std::vector<Linkage>& linkages, std::vector<LinkageMotion>& motions,
             const std::vector<JointState>& joints);
  /// Takes other velocities at the step's start, as impacts have left them.
  void start_with(const Vector& velocity, const ContactStep& step, const std::vector<JointState>& joints);

  /// What many bodies may take is bounded, and their error what can be seen.
  Effort effort() const;
  void restart() { velocity_ = start_; }
  void evaluate(bool renew_limits);
  double error_squared() const;
  double scale() const { return scale_; }
  /// What hangs on joints is solved for by the part of the forces' impulse alone.
  static double unseen() { return std::numeric_limits<double>::infinity(); }
  void factorise();
  void find_direction();
  void move(double part) { velocity_ += part * direction_; }
  double energy() const;
  double descent() const { return gradient_.dot(direction_); }

  const Vector& start() const { return start_; }
  const Vector& velocity() const { return velocity_; }
  const Matrix& jacobian() const { return jacobian_; }
  /// Which joint's velocity an unknown is, as an index in Scene::joints; -1 of a body that flies.
  int joint_of(Eigen::Index unknown) const { return unknowns_[static_cast<std::size_t>(unknown)].joint; }
  void note_limit_impulse(Eigen::Index joint, double impulse) {
    laws_[static_cast<std::size_t>(joint)].note_limit_impulse(impulse);
  }
  /// Solves the mass matrix for velocities, in place.
  void solve_mass(Vector& momenta) const { mass_factors_.solveInPlace(momenta); }
  const Matrix& mass() const { return mass_; }
  /// Whether anything but gravity acts, or may.
  bool acts() const { return acts_; }

  /// Kinetic energy of a velocity of the unknowns [J].
  double kinetic_energy(const Vector& velocity) const { return 0.5 * velocity.dot(mass_ * velocity); }
  /// Of a solution that does not agree with its forces: slows it down to what springs and hands can have made
  /// of it.
  void keep_to_energy(const ContactStep& step, const Island& island);

  /// Gives contacts, joints and bodies what they have become.
  void finish(bool agree, ContactStep& step, const Island& island, std::vector<JointState>& joints);

 private:
  struct Unknown {
    int joint;                // index in Scene::joints, or -1 of the six of a free body
    int body;                 // that it moves
    double gyration_squared;  // by which a torque counts as a force; 1 of a force [m^2]
  };
  void number(const ContactStep& step, const Island& island, const std::vector<Linkage>& linkages,
              std::vector<LinkageMotion>& motions);
  void add_linkage(const ContactStep& step, const Island& island, const Linkage& linkage,
                   LinkageMotion& motion);
  void add_free(const ContactStep& step, const Island& island, std::size_t index);

  IslandProblem several_;
  const double usual_;
  double step_ = 0.0, scale_ = 0.0, carried_ = 0.0;
  bool acts_ = false;
  std::vector<Unknown> unknowns_;
  std::vector<JointLaw> laws_;  // by unknown that is a joint's
  const Scene* scene_ = nullptr;
  Matrix jacobian_, mass_, hessian_, product_;
  Eigen::LLT<Matrix> mass_factors_, factors_;
  Vector start_, free_, fall_, velocity_, direction_, gradient_;
  Vector body_velocity_, body_start_, body_free_;
};

}  // namespace mrhi
