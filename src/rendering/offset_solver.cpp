#include "offset_solver.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

constexpr int kMaxSweeps = 40;
constexpr double kSettled = 1e-5;       // no gap changes by more in a sweep [m]
constexpr double kFarthestTurn = 0.25;  // in one go: rotations are linearised [rad]

using Array4 = Eigen::Array4d;

/// A finger's share of the unknowns: `free` without regard to the limits, `held` within them.
struct Part {
  FingerOffset lower, upper, compliance, free, held;
};

/// With multipliers l >= 0 of the gaps, W (q - q0) = J^T l, less what limits hold. W is diagonal, so that for
/// given l the best q within the limits is each component of q0 + W^-1 J^T l clamped by itself: `free` before
/// and `held` after it. The dual function of l that is left is concave, and going up along one l after the
/// other leads to its top.
class OffsetProblem {
 public:
  OffsetProblem(const HandOffset& reference, const OffsetBounds& bounds, HandChain& chain,
                std::vector<Clearance>& clearances, const HandOffset& from)
      : bounds_(bounds), clearances_(clearances) {
    shift_ << reference.shift.array(), 0.0;
    used_.fill(false);
    for (Clearance& clearance : clearances_) {
      const int f = HandChain::finger_that_moves(clearance.key.capsule);
      if (f >= 0) use(f, reference, chain, from);
      begin(clearance, f, from);
    }
  }

  void solve() {
    for (int sweep = 0; sweep < kMaxSweeps; ++sweep) {
      double largest = 0.0;
      for (Clearance& clearance : clearances_) largest = std::max(largest, relax(clearance));
      if (largest < kSettled) return;
    }
  }

  double least_gap() {
    double least = 0.0;
    for (const Clearance& clearance : clearances_)
      least = std::min(least, gap_of(clearance, part_of(clearance)));
    return least;
  }

  void result(const HandOffset& reference, HandOffset& offset) const {
    offset.shift = shift_.head<3>();
    for (std::size_t f = 0; f < kFingers; ++f)
      offset.fingers[f] = used_[f] ? parts_[f].held : reference.fingers[f];
  }

 private:
  /// Bounds are taken together, limits last, so that lower <= upper whatever pace asks for: joints' limits
  /// are never given up.
  void use(int finger, const HandOffset& reference, HandChain& chain, const HandOffset& from) {
    const auto f = static_cast<std::size_t>(finger);
    if (used_[f]) return;
    used_[f] = true;
    const FingerChain& fingers_chain = chain.finger(finger);
    Part& part = parts_[f];
    const FingerOffset swing = fingers_chain.swing(bounds_.swing);
    const FingerOffset &now = from.fingers[f], &before = bounds_.before.fingers[f];
    part.upper =
        fingers_chain.upper().min(now + kFarthestTurn).min(before + swing).max(fingers_chain.lower());
    part.lower = fingers_chain.lower().max(now - kFarthestTurn).max(before - swing).min(part.upper);
    part.compliance = fingers_chain.compliance();
    part.free = reference.fingers[f];
    part.held = part.free.max(part.lower).min(part.upper);
  }

  /// rest = gap - J q_k, so that the gap is rest + J q. Pressures of the last pass are put in first.
  void begin(Clearance& clearance, int finger, const HandOffset& from) {
    clearance.rest = clearance.gap - (clearance.by_shift.head<3>() * from.shift.array()).sum();
    shift_ += (kShiftCompliance * clearance.pressure) * clearance.by_shift;
    if (finger < 0) return;
    const auto f = static_cast<std::size_t>(finger);
    clearance.rest -= (clearance.by_finger * from.fingers[f]).sum();
    give_way(parts_[f], clearance, clearance.pressure);
  }

  static void give_way(Part& part, const Clearance& clearance, double pressure) {
    part.free += (pressure * part.compliance) * clearance.by_finger;
    part.held = part.free.max(part.lower).min(part.upper);
  }

  double gap_of(const Clearance& clearance, const Part* part) const {
    const double gap = clearance.rest + (clearance.by_shift * shift_).sum();
    return part == nullptr ? gap : gap + (clearance.by_finger * part->held).sum();
  }
  Part* part_of(const Clearance& clearance) {
    const int finger = HandChain::finger_that_moves(clearance.key.capsule);
    return finger < 0 ? nullptr : &parts_[static_cast<std::size_t>(finger)];
  }

  /// Closes one gap, or lets go as far as it is open; returns by how much it changes [m].
  /// dgap / dl = J W^-1 J^T over what is free to move; a step of -gap / (dgap / dl) brings the gap to 0, or
  /// the pressure to 0 if it would pull. Where a joint meets its limit on the way the gap falls short, and
  /// the next sweep goes on.
  double relax(Clearance& clearance) {
    Part* part = part_of(clearance);
    const double gap = gap_of(clearance, part);
    if (gap >= 0.0 && clearance.pressure == 0.0) return 0.0;
    double compliance = kShiftCompliance * clearance.by_shift.square().sum();
    if (part != nullptr) compliance += free_compliance(*part, clearance.by_finger, gap);
    const double pressure = std::max(0.0, clearance.pressure - gap / compliance);
    const double change = pressure - clearance.pressure;
    clearance.pressure = pressure;
    shift_ += (kShiftCompliance * change) * clearance.by_shift;
    if (part != nullptr) give_way(*part, clearance, change);
    return std::abs(change) * compliance;
  }

  /// Of the joints that their limits let go the way that closes the gap.
  static double free_compliance(const Part& part, const FingerOffset& by_finger, double gap) {
    double sum = 0.0;
    for (int i = 0; i < 4; ++i) {
      const bool up = (by_finger[i] > 0.0) == (gap < 0.0);
      const bool stopped = up ? part.free[i] >= part.upper[i] : part.free[i] <= part.lower[i];
      sum += stopped ? 0.0 : part.compliance[i] * by_finger[i] * by_finger[i];
    }
    return sum;
  }

  const OffsetBounds& bounds_;
  std::vector<Clearance>& clearances_;
  Array4 shift_;
  std::array<Part, kFingers> parts_;
  std::array<bool, kFingers> used_;
};

}  // namespace

double solve_offset(const HandOffset& reference, const OffsetBounds& bounds, HandChain& chain,
                    std::vector<Clearance>& clearances, HandOffset& offset) {
  OffsetProblem problem(reference, bounds, chain, clearances, offset);
  problem.solve();
  problem.result(reference, offset);
  return problem.least_gap();
}

}  // namespace mrhi
