#pragma once

#include <Eigen/Core>
#include <array>

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

}  // namespace mrhi
