#include "block_system.h"

#include <algorithm>
#include <tuple>

namespace mrhi {
namespace {

/// Springs of many bodies need about as many turns as the bodies that a push runs through, and some more.
constexpr int kMostTurns = 120;

}  // namespace

bool BlockSystem::before(const Coupling& x, const Coupling& y) {
  return std::tie(x.column, x.row) < std::tie(y.column, y.row);
}

void BlockSystem::begin(int bodies) {
  diagonal_.resize(static_cast<std::size_t>(bodies));
  factors_.resize(static_cast<std::size_t>(bodies));
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

void BlockSystem::to_dense(Eigen::MatrixXd& result) const {
  result.setZero(6 * bodies(), 6 * bodies());
  for (int i = 0; i < bodies(); ++i)
    result.block<6, 6>(6 * i, 6 * i) = diagonal_[static_cast<std::size_t>(i)];
  for (const Coupling& c : couplings_) result.block<6, 6>(6 * c.row, 6 * c.column) = c.value;
}

void BlockSystem::factorise() {
  if (bodies() <= kMostDense) {
    to_dense(dense_);
    dense_factors_.compute(dense_);
    return;
  }
  for (std::size_t i = 0; i < diagonal_.size(); ++i) {
    double entries[Cholesky6::kEntries];
    for (int row = 0; row < 6; ++row) {
      for (int column = 0; column <= row; ++column)
        entries[Cholesky6::at(row, column)] = diagonal_[i](row, column);
    }
    factors_[i].factorise(entries);
  }
}

void BlockSystem::multiply(const Eigen::VectorXd& x, Eigen::VectorXd& result) const {
  for (int i = 0; i < bodies(); ++i)
    result.segment<6>(6 * i).noalias() = diagonal_[static_cast<std::size_t>(i)] * x.segment<6>(6 * i);
  for (const Coupling& c : couplings_) {
    result.segment<6>(6 * c.row).noalias() += c.value * x.segment<6>(6 * c.column);
    result.segment<6>(6 * c.column).noalias() += c.value.transpose() * x.segment<6>(6 * c.row);
  }
}

void BlockSystem::precondition(const Eigen::VectorXd& x, Eigen::VectorXd& result) const {
  for (int i = 0; i < bodies(); ++i)
    result.segment<6>(6 * i) = factors_[static_cast<std::size_t>(i)].solve(x.segment<6>(6 * i));
}

/// Conjugate gradients (Hestenes & Stiefel 1952), each body's own block as preconditioner.
void BlockSystem::solve(Eigen::VectorXd& x, double tolerance) {
  if (bodies() <= kMostDense) return dense_factors_.solveInPlace(x);
  residual_ = x;
  x.setZero();
  for (Eigen::VectorXd* vector : {&weighed_, &image_}) vector->resize(x.size());
  precondition(residual_, weighed_);
  along_ = weighed_;
  double size = residual_.dot(weighed_);
  const double enough = tolerance * tolerance * size;
  for (int turn = 0; turn < kMostTurns && size > enough; ++turn) {
    multiply(along_, image_);
    const double part = size / along_.dot(image_);
    x += part * along_;
    residual_ -= part * image_;
    precondition(residual_, weighed_);
    const double last = size;
    size = residual_.dot(weighed_);
    along_ = weighed_ + (size / last) * along_;
  }
}

}  // namespace mrhi
