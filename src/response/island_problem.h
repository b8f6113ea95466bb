#pragma once

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>
#include <vector>

#include "islands.h"
#include "spring_contact.h"

namespace mrhi {

/// Of the bodies of an island, which are numbered from 0: body 2 is number `b`, body 1 number `a` or, moving
/// by itself, none of them.
struct IslandContact : SpringContact<double> {
  static constexpr int kAlone = -1;
  int a, b;
  Vector3 arm_a;  // from the centre of a [m]
};

/// Several bodies that touch each other, and what presses them: six unknowns a body, solved together. A
/// Problem for Newton. Keeps its memory from island to island.
class IslandProblem {
 public:
  static constexpr bool kTrustsLastStep = false;  // momentum is conserved between the bodies

  void begin(ContactStep& step, const Island& island, const ContactConfiguration& configuration);

  void restart() { velocity_ = start_; }
  void evaluate(bool renew_limits);
  double error_squared() const;
  double scale() const { return scale_; }
  void factorise();
  void find_direction();
  void move(double part) { velocity_ += part * direction_; }
  double energy() const;
  double descent() const { return gradient_.dot(direction_); }

  /// Gives the contacts what they have become, and the bodies their momenta at the step's end: what the
  /// forces make of them where these and the velocity `agree`, so that none is lost between bodies.
  void finish(bool agree, ContactStep& step, const Island& island) const;

 private:
  using Vector6 = Eigen::Matrix<double, 6, 1>;
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  struct Mass {
    double mass;
    double gyration_squared;  // [m^2]
    Matrix3 inertia;          // world axes
  };
  /// Blocks of the Hessian that two bodies share: row below or on the diagonal.
  struct Block {
    int row, column;
    Matrix6 value;
  };

  Eigen::Index size() const { return static_cast<Eigen::Index>(6 * masses_.size()); }
  Vector3 velocity_at(int body, const Vector3& arm) const;
  Vector3 relative_velocity(const IslandContact& contact) const;
  double relative_spin(const IslandContact& contact) const;
  void begin_body(const Body& body, const BodyState& state, const Vector3& gravity);
  void add_contacts(const ContactStep& step, const Island& island, const ContactConfiguration& configuration);
  void list_blocks();
  void factorise_sparse();

  std::vector<IslandContact> contacts_;
  double step_ = 0.0;
  std::vector<Mass> masses_;
  Eigen::VectorXd start_, free_, velocity_, direction_, gradient_;
  std::vector<Block> blocks_;         // the diagonal ones first, then those of touching pairs, sorted
  std::vector<std::size_t> couples_;  // by contact: its block off the diagonal
  Eigen::MatrixXd dense_;
  Eigen::LLT<Eigen::MatrixXd> dense_factors_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> sparse_factors_;
  double scale_ = 0.0;
};

}  // namespace mrhi
