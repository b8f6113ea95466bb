#include "block_system.h"

namespace mrhi {

void BlockSystem::begin(int bodies) {
  diagonal_.resize(static_cast<std::size_t>(bodies));
  couplings_.clear();
}

std::size_t BlockSystem::couple(int a, int b) {
  if (couplings_.empty() || couplings_.back().column != a || couplings_.back().row != b)
    couplings_.push_back({b, a, Matrix6::Zero()});
  return couplings_.size() - 1;
}

void BlockSystem::clear() {
  for (Matrix6& block : diagonal_) block.setZero();
  for (Coupling& coupling : couplings_) coupling.value.setZero();
}

// Only the lower triangle is set: LLT reads no other.
void BlockSystem::to_dense(Eigen::MatrixXd& result) const {
  result.setZero(6 * bodies(), 6 * bodies());
  for (int i = 0; i < bodies(); ++i)
    result.block<6, 6>(6 * i, 6 * i) = diagonal_[static_cast<std::size_t>(i)];
  for (const Coupling& c : couplings_) result.block<6, 6>(6 * c.row, 6 * c.column) = c.value;
}

// Of islands with joints J' A J is wanted in place of a solution (linkage_problem.cpp). Most blocks are
// empty: block by block it takes a tenth of the dense product of 18 bodies.
void BlockSystem::multiply(const Eigen::MatrixXd& by, Eigen::MatrixXd& result) const {
  result.resize(by.rows(), by.cols());
  for (int i = 0; i < bodies(); ++i)
    result.middleRows<6>(6 * i).noalias() = diagonal_[static_cast<std::size_t>(i)] * by.middleRows<6>(6 * i);
  for (const Coupling& c : couplings_) {
    result.middleRows<6>(6 * c.row).noalias() += c.value * by.middleRows<6>(6 * c.column);
    result.middleRows<6>(6 * c.column).noalias() += c.value.transpose() * by.middleRows<6>(6 * c.row);
  }
}

// A = L L' (Cholesky), dense: of the few bodies of an island, most are coupled with most.
// A is positive definite, M and slopes that are not negative, so that no pivots are needed (Golub & Van
// Loan, Matrix Computations, 4.2). n bodies take (6 n)^3 / 6 multiplications, a column of ten 36 000.
void BlockSystem::factorise() {
  to_dense(dense_);
  factors_.compute(dense_);
}

void BlockSystem::solve(Eigen::VectorXd& x) const {
  factors_.solveInPlace(x);
}

}  // namespace mrhi
