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
  /// The number of the block that two bodies share from now on, `a` before `b`. Asked again right away it is
  /// the same; later it would be another, so that what a pair has is asked for together.
  std::size_t couple(int a, int b);

  /// All entries zero.
  void clear();
  /// Of body `i` with itself.
  Matrix6& diagonal(int i) { return diagonal_[static_cast<std::size_t>(i)]; }
  /// Rows of the later body, columns of the earlier.
  Matrix6& between(std::size_t coupling) { return couplings_[coupling].value; }

  /// A times another matrix.
  void multiply(const Eigen::MatrixXd& by, Eigen::MatrixXd& result) const;

  /// Call when the entries are there.
  void factorise();
  /// Solves in place, to rounding.
  void solve(Eigen::VectorXd& x) const;

 private:
  struct Coupling {
    int row, column;  // row > column
    Matrix6 value;
  };

  void to_dense(Eigen::MatrixXd& result) const;
  int bodies() const { return static_cast<int>(diagonal_.size()); }

  std::vector<Matrix6> diagonal_;
  std::vector<Coupling> couplings_;
  Eigen::MatrixXd dense_;
  Eigen::LLT<Eigen::MatrixXd> factors_;
};

/// Solves A x = b for a symmetric positive definite 6 x 6 matrix by its factors L D L'. Only the lower
/// triangle is kept, row by row; loops over it are unrolled, which makes it several times as fast as one of
/// any size.
///
///     A = L D L',   d_k = a_kk,   l_ik = a_ik / d_k,   a_ij -= l_ik a_jk for i >= j > k      (k = 0 to 5)
///     L y = b,   D z = y,   L' x = z
///
/// By columns, each taking its part off all that is to the right of it (Golub & Van Loan, Matrix
/// Computations, 4.1). No roots, as L L' would need, and divisions six in all; no pivots, as A is positive
/// definite.
class Cholesky6 {
 public:
  static constexpr int kEntries = 21;
  static constexpr int at(int row, int column) { return row * (row + 1) / 2 + column; }

  /// `entries` hold A.
  void factorise(const double (&entries)[kEntries]) {
    for (int i = 0; i < kEntries; ++i) lower_[i] = entries[i];
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
  double lower_[kEntries];  // L, which has ones on its diagonal, where D stands instead
  double inverse_[6];       // of D
};

}  // namespace mrhi
