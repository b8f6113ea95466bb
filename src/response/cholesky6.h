#pragma once

#include <Eigen/Core>
#include <array>

namespace mrhi {

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
  double lower_[kEntries];  // L, which has ones on its diagonal, where D stands instead
  double inverse_[6];       // of D
};

}  // namespace mrhi
