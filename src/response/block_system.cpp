#include "block_system.h"

#include <algorithm>
#include <tuple>

namespace mrhi {

bool BlockSystem::before(const Coupling& x, const Coupling& y) {
  return std::tie(x.column, x.row) < std::tie(y.column, y.row);
}

void BlockSystem::begin(int bodies) {
  diagonal_.resize(static_cast<std::size_t>(bodies));
  couplings_.clear();
}

void BlockSystem::couple(int a, int b) {
  const int row = std::max(a, b), column = std::min(a, b);
  // The contacts of a pair follow each other.
  if (!couplings_.empty() && couplings_.back().row == row && couplings_.back().column == column) return;
  couplings_.push_back({row, column, Matrix6::Zero()});
}

void BlockSystem::arrange() {
  const auto same = [](const Coupling& x, const Coupling& y) { return !before(x, y) && !before(y, x); };
  if (!std::is_sorted(couplings_.begin(), couplings_.end(), before))
    std::sort(couplings_.begin(), couplings_.end(), before);
  couplings_.erase(std::unique(couplings_.begin(), couplings_.end(), same), couplings_.end());
}

std::size_t BlockSystem::coupling(int a, int b) const {
  const Coupling wanted{std::max(a, b), std::min(a, b), Matrix6::Zero()};
  return static_cast<std::size_t>(std::lower_bound(couplings_.begin(), couplings_.end(), wanted, before) -
                                  couplings_.begin());
}

void BlockSystem::clear() {
  for (Matrix6& block : diagonal_) block.setZero();
  for (Coupling& coupling : couplings_) coupling.value.setZero();
}

// Only the lower triangle is set: LLT reads no other.
// Of islands with joints J' A J is wanted in place of a solution (linkage_problem.cpp).
void BlockSystem::to_dense(Eigen::MatrixXd& result) const {
  result.setZero(6 * bodies(), 6 * bodies());
  for (int i = 0; i < bodies(); ++i)
    result.block<6, 6>(6 * i, 6 * i) = diagonal_[static_cast<std::size_t>(i)];
  for (const Coupling& c : couplings_) result.block<6, 6>(6 * c.row, 6 * c.column) = c.value;
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
