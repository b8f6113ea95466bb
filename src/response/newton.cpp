#include <cmath>

#include "island_problem.h"

// Newton's method with the friction limits of the last iterate. Each iterate's problem is convex: g(u) = M (u
// - u*) - h J' f(u; L) = 0. While the limits L are held, g is the gradient of a convex, once differentiable
// E(u), and H = M + h J' K J is positive definite by its M:
//
//     H d = -g(u),     u <- u + s d,     s = 1 where it will do
//
// Forces have kinks where contacts open and slip. There H is one of the generalised Hessians, and this is a
// semismooth Newton method (Qi & Sun 1993). If the set of open contacts is known and all others stick, forces
// are linear in u but for the release fade and the pad. One step is then practically exact. Where contacts
// slip under renewed limits, H lacks dL/dN (see Spring::evaluate), so convergence is linear. Hessians are
// reused while the error falls fast (the chord method; Kelley 1995, ch. 5).
namespace mrhi {
namespace {

/// A line search bisects after so many trials: friction of a very light body is almost a leap.
constexpr int kSecants = 20;
/// A line search ends at this ratio of the energy's slope to that at its start.
constexpr double kSlopeTolerance = 0.01;
/// Convergence is fast if a step reduces the error below this ratio: the Hessian hardly changes there.
constexpr double kFastRatio = 0.05;
/// Error, over scale(), from which fast convergence reaches Effort::converged in one more step.
constexpr double kLastStepError = 1e-5;
/// The same for the first step, which has a Hessian of its own, if the warm start is this good: the error
/// falls quadratically (measured: 4e-11 of 3e-5).
constexpr double kFirstStepError = 1e-4;
/// Error, over scale(), below which energy differences are rounding and a line search is useless.
constexpr double kEnergyPrecision = 1e-5;
/// Error, over scale(), that is rounding of its terms.
constexpr double kRoundingError = 1e-12;

}  // namespace

// The last step of a single body is not verified: no momentum is exchanged that could be lost by it.
bool IslandProblem::solve() {
  double last = 0.0;
  for (int i = 0; i < effort_.iterations; ++i) {
    evaluate(true);
    if (solved()) return true;
    const double error = error_squared();
    const bool near = i > 0 && error < kFastRatio * kFastRatio * last;
    last = error;
    const bool last_step = near ? error_below(kLastStepError) : i == 0 && error_below(kFirstStepError);
    if (!in_joints_ && last_step) {
      advance(false, near);
      return false;
    }
    advance(i >= effort_.full_steps && !near, near);
  }
  solve_with_held_limits();
  return false;
}

/// Compares the error with a ratio of scale().
bool IslandProblem::error_below(double ratio) const {
  // The constant is for bodies on which nothing acts, where a relative error is undefined [N s].
  const double limit = ratio * scale_ + 1e-18;
  return error_squared() <= limit * limit;
}

/// True if the error is below Effort::converged and invisible. Momenta at the end of the step follow from the
/// forces found, so a residual loses no momentum, but it moves bodies. In a long step with large forces even
/// a small ratio of their impulse is a visible displacement.
bool IslandProblem::solved() const {
  if (!error_below(effort_.converged)) return false;
  return error_squared() <= invisible_impulse_ * invisible_impulse_ || error_below(kRoundingError);
}

/// Fallback where limits and velocity do not converge together. Solves the convex problem with limits held,
/// renews the limits, and repeats. The solution for any limits is passive, so stopping at any time adds no
/// energy.
///
/// With limits held the problem is that of Tresca's friction, which has one solution; a fixed point of
/// `solve, renew` solves Coulomb's (Panagiotopoulos 1975, Haslinger 1983). Convergence is proven for small
/// coefficients only, hence the bound.
void IslandProblem::solve_with_held_limits() {
  if (effort_.restarts) velocity_ = start_;
  for (int renewed = 0; renewed < effort_.limits; ++renewed) {
    evaluate(true);
    for (int i = 0; i < effort_.held_iterations && !solved(); ++i) {
      advance(true, false);
      evaluate(false);
    }
  }
}

void IslandProblem::advance(bool checked, bool same_hessian) {
  if (!same_hessian) factorise();
  find_direction();
  const bool searches = checked && !error_below(kEnergyPrecision);
  // Armijo's condition, E(u + d) <= E(u) + 1e-4 g.d, where g.d = -d'H d < 0 (Nocedal & Wright, Numerical
  // Optimization, 2006, 3.1).
  const double before = searches ? energy() : 0.0, slope = searches ? descent() : 0.0;
  velocity_ += direction_;
  if (searches && energy() > before + 1e-4 * slope) search_line(slope);
}

/// Moves back from the end of a step that overshoots to about the least energy along it, where the slope
/// passes zero. Halving the step until it satisfies Armijo is not enough: a light object between stiff
/// fingers then alternates across the rim of the friction cone and hardly advances.
void IslandProblem::search_line(double slope_at_start) {
  // phi(s) = E(u + s d) has phi' = g(u + s d).d, which grows with s as E is convex. So phi'(0) < 0 and
  // phi'(1) > 0 bracket one zero. False position may approach it from one side only, so every third trial
  // bisects.
  double low = 0.0, high = 1.0, part = 1.0, low_slope = slope_at_start;
  evaluate(false);
  double high_slope = descent();
  for (int i = 0; i < effort_.trials && high_slope > 0.0; ++i) {
    const double secant = low - low_slope * (high - low) / (high_slope - low_slope);
    const double next = i % 3 == 2 || i >= kSecants ? 0.5 * (low + high) : secant;
    velocity_ += (next - part) * direction_;
    part = next;
    evaluate(false);
    const double slope = descent();
    if (std::abs(slope) <= kSlopeTolerance * -slope_at_start) return;
    (slope > 0.0 ? high : low) = next;
    (slope > 0.0 ? high_slope : low_slope) = slope;
  }
}

}  // namespace mrhi
