#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <array>
#include <vector>

#include "../joints/joint_law.h"
#include "../joints/linkage.h"
#include "islands.h"
#include "spring_contact.h"

namespace mrhi {

/// Solves A x = b for a symmetric positive definite 6 x 6 matrix by the factors L D L'. Only the lower
/// triangle is stored, row by row. Loops are unrolled, which is several times as fast as code for any size.
///
///     A = L D L',   d_k = a_kk,   l_ik = a_ik / d_k,   a_ij -= l_ik a_jk for i >= j > k      (k = 0 to 5)
///     L y = b,   D z = y,   L' x = z
///
/// Right-looking, column by column (Golub & Van Loan, Matrix Computations, 4.1). Unlike L L' it needs no
/// roots, and only six divisions. Pivots are not needed, as A is positive definite.
class Cholesky6 {
 public:
  static constexpr int kEntries = 21;
  static constexpr int at(int row, int column) { return row * (row + 1) / 2 + column; }

  /// `entries`: the lower triangle of A.
  void factorise(const std::array<double, kEntries>& entries) {
    for (std::size_t i = 0; i < kEntries; ++i) lower_[i] = entries[i];
#pragma GCC unroll 6
    for (int k = 0; k < 6; ++k) {
      inverse_[k] = 1.0 / lower_[at(k, k)];
      double column[6];
#pragma GCC unroll 6
      for (int i = k + 1; i < 6; ++i) {
        column[i] = lower_[at(i, k)];
        lower_[at(i, k)] *= inverse_[k];
      }
#pragma GCC unroll 6
      for (int i = k + 1; i < 6; ++i) {
#pragma GCC unroll 6
        for (int j = k + 1; j <= i; ++j) lower_[at(i, j)] -= lower_[at(i, k)] * column[j];
      }
    }
  }

  Eigen::Matrix<double, 6, 1> solve(Eigen::Matrix<double, 6, 1> x) const {
#pragma GCC unroll 6
    for (int i = 0; i < 6; ++i) {
#pragma GCC unroll 6
      for (int k = 0; k < i; ++k) x[i] -= lower_[at(i, k)] * x[k];
    }
#pragma GCC unroll 6
    for (int i = 5; i >= 0; --i) {
      x[i] *= inverse_[i];
#pragma GCC unroll 6
      for (int k = i + 1; k < 6; ++k) x[i] -= lower_[at(k, i)] * x[k];
    }
    return x;
  }

 private:
  double lower_[kEntries];  // L without its diagonal of ones, where D is stored
  double inverse_[6];       // of D
};

/// The lower triangle of a symmetric 6 x 6 matrix, row by row (Cholesky6::at).
using Lower6 = std::array<double, Cholesky6::kEntries>;

struct Symmetric3 {
  double xx, xy, yy, xz, yz, zz;

  /// Adds weight v v'.
  void add(double weight, const Triple& v) {
    const Triple w = weight * v;
    xx += w.x * v.x, xy += w.x * v.y, yy += w.y * v.y;
    xz += w.x * v.z, yz += w.y * v.z, zz += w.z * v.z;
  }
  Matrix3 matrix() const { return (Matrix3() << xx, xy, xz, xy, yy, yz, xz, yz, zz).finished(); }
};

/// Returns S = -d force / d velocity of 2 at the contact point, by the row's last response.
Symmetric3 point_slope(const SpringContact& row);
/// Adds J' S J = -d (force, torque) / d (velocity, angular velocity) of a body on which the row acts at
/// `arm`.
void add_slope(const SpringContact& row, const Symmetric3& s, const Triple& arm, Lower6& sum);

/// Cholesky factors of a positive definite matrix, by its lower triangle. Those of many unknowns are sparse:
/// a row of an island's matrix has entries for the bodies that touch alone.
class Factors {
 public:
  void compute(const Eigen::MatrixXd& matrix);
  void solve_in_place(Eigen::VectorXd& right_hand_side) const;

 private:
  bool sparse_ = false;
  Eigen::LLT<Eigen::MatrixXd> dense_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> ordered_;
};

/// The contact problem of one body, or of an island with joints, at the end of the step: M (u - u*) = h J'
/// f(J u), with f the springs' forces and u* the velocities under gravity alone. The unknowns u are the
/// body's linear and angular velocity in world axes. In an island with joints they are the joints'
/// velocities, and six for each body without a joint. Solved by Newton's method. Keeps its memory from island
/// to island.
class IslandProblem {
 public:
  /// An island of one body.
  void begin(const ContactStep& step, const Island& island);
  /// An island with joints. `linkages` and their placed motions are those of the whole scene. `regular_step`:
  /// the last one of a frame may be shorter [s].
  void begin(const ContactStep& step, const Island& island, const std::vector<Linkage>& linkages,
             std::vector<LinkageMotion>& motions, const std::vector<JointState>& joints, double regular_step);
  /// The body of an operator whose hands touch fixtures. `carrier`: motion that carries the hands.
  void begin_operator(const ContactStep& step, std::size_t body, const std::vector<Contact*>& contacts,
                      const Twist& carrier);

  /// Returns true if the velocity found is consistent with the forces.
  bool solve();
  /// Evaluates the forces at the current velocity, with Coulomb's limits renewed first or held.
  void evaluate(bool renew_limits);
  /// Sum of the acting impulses, which errors are compared with [N s].
  double scale() const { return scale_; }
  /// Velocity of the one body at the end of the step.
  Twist velocity() const {
    return {velocity_.head<3>() + carrier_.linear, velocity_.tail<3>() + carrier_.angular};
  }

  /// Writes the contacts, and the bodies' momenta at the end of the step: from the forces if the velocity is
  /// consistent with them (`agree`), else from the velocity.
  void finish(bool agree, ContactStep& step, const Island& island);
  void finish_operator(ContactStep& step, const std::vector<Contact*>& contacts);

  // For islands with joints.
  using Vector = Eigen::VectorXd;
  using Matrix = Eigen::MatrixXd;
  using PointJacobian = Eigen::Matrix<double, 3, Eigen::Dynamic>;
  /// Replaces the velocities at the start of the step, by those after impacts.
  void start_with(const Vector& velocity, const ContactStep& step, const std::vector<JointState>& joints);
  const Vector& start() const { return start_; }
  const Vector& joint_velocity() const { return velocity_; }
  /// The unknowns that move a body.
  struct Columns {
    Eigen::Index first, count;
  };
  const Columns& columns_of(int number) const { return columns_[number]; }
  /// Adds `sign` times the Jacobian of the point of body `number` at `arm`, to the body's own columns.
  void add_point_jacobian(int number, const Vector3& arm, double sign, Eigen::Ref<PointJacobian> own) const;
  /// The velocity of a joint, or the six of a body without one.
  struct Unknown {
    int joint;  // index in Scene::joints, or LinkageBody::kNone
    int body;   // the body that it moves
    Eigen::Index row;
  };
  const std::vector<Unknown>& unknowns() const { return unknowns_; }
  void note_limit_impulse(Eigen::Index joint, double impulse) { laws_[joint].note_limit_impulse(impulse); }
  /// Multiplies by the inverse mass matrix, in place: momenta become velocities.
  void solve_mass(Vector& momenta) const { mass_factors_.solve_in_place(momenta); }
  /// True if anything but gravity acts or may act.
  bool acts() const { return acts_; }
  /// Scales the velocity of an inconsistent solution down to the energy that springs and hands can have
  /// given.
  void keep_to_energy(const ContactStep& step, const Island& island);
  void finish(bool agree, ContactStep& step, const Island& island, std::vector<JointState>& joints);

 private:
  /// Sum of the forces of a body's rows.
  struct Wrench {
    Triple force, torque;  // [N], [N m]
  };
  struct OneBody {
    std::size_t index;  // in Scene::bodies
    double mass;
    Matrix3 inertia;  // world axes
  };
  /// Limits of the iteration.
  struct Effort {
    int iterations = 40;       // with Coulomb's limits renewed in each
    int limits = 8;            // renewals of held limits after these
    int held_iterations = 60;  // after each renewal
    int full_steps = 2;       // first iterations without a line search: exact while no contact opens or slips
    bool restarts = true;     // true if held limits restart from the start of the step, not the last iterate
    int trials = 50;          // per line search
    double converged = 1e-7;  // largest error of a solution, over scale()
  };

  // Newton's method (newton.cpp).
  double error_squared() const;
  bool error_below(double ratio) const;
  bool solved() const;
  void solve_with_held_limits();
  void advance(bool checked, bool same_hessian);
  void search_line(double slope_at_start);
  void factorise();
  void find_direction();
  double energy();
  double descent() const { return gradient_.dot(direction_); }

  void begin_body(const ContactStep& step, std::size_t index);
  void begin(std::size_t bodies, bool in_joints);
  void make_rows(const ContactStep& step, const Island& island);
  int coupled_operator(const ContactStep& step, const Island& island) const;
  void couple(const ContactStep& step, const Body& body, const BodyState& state, std::size_t op);
  void finish_body(bool agree, ContactStep& step) const;
  void settle_rows(ContactStep& step, const Island& island) const;

  const Vector& body_velocity() const { return in_joints_ ? body_velocity_ : velocity_; }
  Triple linear_velocity(int number) const { return triple(body_velocity().segment<3>(6 * number)); }
  Triple angular_velocity(int number) const { return triple(body_velocity().segment<3>(6 * number + 3)); }
  void relative_motion(const SpringContact& row, Triple& velocity, double& spin) const;
  void multiply_mass(const Vector& by, Vector& result) const;

  // Joints (island_joints.cpp).
  Effort effort_in_joints() const;
  void number_unknowns(const ContactStep& step, const Island& island, const std::vector<Linkage>& linkages,
                       std::vector<LinkageMotion>& motions);
  void add_linkage(const ContactStep& step, const Island& island, const Linkage& linkage,
                   LinkageMotion& motion, Eigen::Index first);
  void add_body_without_joint(const ContactStep& step, const Island& island, std::size_t index,
                              Eigen::Index first);
  void find_body_velocities();
  void add_joint_forces();
  double joint_energy() const;
  void factorise_joints();
  void add_body_slope(int number);
  double kinetic_energy(const Vector& velocity) {
    multiply_mass(velocity, momentum_);
    return 0.5 * velocity.dot(momentum_);
  }

  Effort effort_;
  double step_ = 0.0, scale_ = 0.0;
  double invisible_impulse_ = 0.0;          // an impulse of the one body whose effect is invisible [N s]
  std::vector<SpringContact> rows_;         // of hands, grips and contacts between bodies, in this order
  std::vector<Wrench> wrenches_;            // by body's number, of the last iterate
  OneBody one_;                             // in an island without joints
  Vector start_, free_;                     // u at the start of the step, and u*
  Vector velocity_, direction_, gradient_;  // u of the iterate, Newton step, and residual impulse
  Vector weights_;  // of squared components of the gradient: 1, or 1/k^2 for torques [1/m^2]
  Vector change_, momentum_;
  Cholesky6 factors_of_one_;
  Matrix hessian_;
  Factors factors_;

  // One body solved with the operator whose hands act on it: velocities are relative to the operator.
  bool coupled_ = false;
  Matrix mass_;    // reduced mass of the two, or the joint island's mass matrix
  Twist carrier_;  // velocity of the operator at the body's centre

  bool in_joints_ = false, acts_ = false;
  double regular_step_ = 0.0, start_momentum_ = 0.0;
  const Scene* scene_ = nullptr;
  std::vector<Unknown> unknowns_;
  std::vector<JointLaw> laws_;    // by row; used for joints
  std::vector<Columns> columns_;  // by body
  struct Part {                   // a linkage, or a body without a joint
    Columns columns;
    LinkageMotion* motion;  // null for a body without a joint
    const Linkage* linkage;
    int number;  // of a body without a joint
  };
  std::vector<Part> parts_;
  const Island* island_ = nullptr;
  Matrix jacobian_;  // of the bodies by the unknowns
  PointJacobian point_jacobian_, point_product_;
  Eigen::RowVectorXd spin_jacobian_;
  std::vector<Lower6> body_slopes_;
  Factors mass_factors_;
  Vector fall_, body_velocity_, body_impulse_;
};

}  // namespace mrhi
