#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <vector>

namespace mrhi {

/// Linear equations A x = b of a few bodies, with six unknowns each and a coupling between some pairs of
/// them; A is symmetric, positive definite. Keeps its memory.
class BlockSystem {
 public:
  using Matrix6 = Eigen::Matrix<double, 6, 6>;
  /// Begins anew with so many bodies, none of them coupled.
  void begin(int bodies);
  /// Says that the two are coupled; may say so again. Then arrange(), before any coupling() is asked for.
  void couple(int a, int b);
  void arrange();
  /// Number of the block that two coupled bodies share.
  std::size_t coupling(int a, int b) const;

  /// All entries zero.
  void clear();
  /// Of body `i` with itself.
  Matrix6& diagonal(int i) { return diagonal_[static_cast<std::size_t>(i)]; }
  /// Rows of the later body, columns of the earlier.
  Matrix6& between(std::size_t coupling) { return couplings_[coupling].value; }

  /// A itself, of which only the lower triangle is set.
  void to_dense(Eigen::MatrixXd& result) const;

  /// Call when the entries are there.
  void factorise();
  /// Solves in place, to rounding.
  void solve(Eigen::VectorXd& x) const;

 private:
  struct Coupling {
    int row, column;  // row > column
    Matrix6 value;
  };
  static bool before(const Coupling& x, const Coupling& y);

  int bodies() const { return static_cast<int>(diagonal_.size()); }

  std::vector<Matrix6> diagonal_;
  std::vector<Coupling> couplings_;  // sorted
  Eigen::MatrixXd dense_;
  Eigen::LLT<Eigen::MatrixXd> factors_;
};

}  // namespace mrhi
