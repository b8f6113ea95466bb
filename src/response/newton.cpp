#include <cmath>

#include "island_problem.h"

// Newton's method with the friction limits of the last iterate; each iterate's problem is convex:
// g(u) = M (u - u*) - h J' f(u; L) = 0 with g the gradient of a convex, once differentiable E(u) while the
// limits L are held, and H = M + h J' K J, positive definite by its M:
//
//     H d = -g(u),     u <- u + s d,     s = 1 where it will do
//
// Forces have kinks where contacts open and slip, so H is one of the generalised Hessians there and this is
// a semismooth Newton method (Qi & Sun 1993). Once contacts have their states and all stick, forces are
// linear in u but for the release fade and the pad, and one step is as good as exact; where some slip and
// their limits are renewed, what H leaves out of them (dL/dN, see Spring::respond) makes convergence linear.
// Hessians are kept while the error falls fast (the chord method; Kelley 1995, ch. 5).
namespace mrhi {
namespace {

/// A line search ends where the slope of the energy is this ratio of its first.
constexpr double kFlat = 0.01;
/// A step that leaves less than this ratio of the error was taken where the Hessian hardly changes.
constexpr double kFast = 0.05;
/// Fast convergence takes an error of this size below Effort::converged in one more step,
constexpr double kTrusted = 1e-5;
/// and so does the first one, by a Hessian of its own, where the last step has led this near: what it
/// leaves goes with the square (measured: 4e-11 of 3e-5).
constexpr double kTrustedAtOnce = 1e-4;
/// Below this error the energy is rounding and no guide any more; of the forces' impulse.
constexpr double kFine = 1e-5;
/// A smaller ratio of the forces' impulse is rounding of what goes into it.
constexpr double kRounding = 1e-12;

}  // namespace

// The last step of one body is not measured: no momentum is shared that could be lost by it.
bool IslandProblem::solve() {
  const bool trusts_last_step = !several() && !in_joints_;
  double last = 0.0;
  for (int i = 0; i < effort_.iterations; ++i) {
    evaluate(true);
    if (solved()) return true;
    const double error = error_squared();
    const bool near = i > 0 && error < kFast * kFast * last;
    last = error;
    const bool last_step = near ? error_below(kTrusted) : i == 0 && error_below(kTrustedAtOnce);
    if (trusts_last_step && last_step) {
      advance(false, near);
      return false;
    }
    advance(i >= effort_.unchecked && !near, near);
  }
  solve_with_held_limits();
  return false;
}

bool IslandProblem::error_below(double part) const {
  // The last is for bodies on which nothing acts: of nothing no ratio is reached [N s].
  const double most = part * scale_ + 1e-18;
  return error_squared() <= most * most;
}

/// The momenta at the step's end are what the forces found make of those at its start, so that what is
/// missing here costs no momentum. But it goes into them whole: where forces are large and the step is
/// long, a small ratio of their impulse is a displacement that can be seen.
bool IslandProblem::solved() const {
  if (!error_below(effort_.converged)) return false;
  return error_squared() <= unseen_ * unseen_ || error_below(kRounding);
}

/// Where the limits keep chasing the velocity: they are held while the convex problem is solved to its end,
/// then renewed. The solution for any limits is passive, so whenever this stops nothing is thrown.
/// With limits held the problem is that of Tresca's friction, which has one solution; a fixed point of
/// `solve, renew` solves Coulomb's (Panagiotopoulos 1975, Haslinger 1983). That the iteration reaches one is
/// proven for small coefficients only: hence the bound.
void IslandProblem::solve_with_held_limits() {
  if (effort_.anew) velocity_ = start_;
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
  const bool searches = checked && !error_below(kFine);
  // Armijo's condition, E(u + d) <= E(u) + 1e-4 g.d, where g.d = -d'H d < 0 (Nocedal & Wright, Numerical
  // Optimization, 2006, 3.1).
  const double before = searches ? energy() : 0.0, slope = searches ? descent() : 0.0;
  velocity_ += direction_;
  if (searches && energy() > before + 1e-4 * slope) search_line(slope);
}

/// From the end of a step that went too far to about the least energy along it, where the slope, which
/// grows along the line, passes zero. To halve the step until it will do is not enough: a light object
/// between stiff fingers then alternates across the rim of the friction cone and hardly advances.
void IslandProblem::search_line(double slope_at_start) {
  // phi(s) = E(u + s d), phi' = g(u + s d).d, which grows with s as E is convex: from phi'(0) < 0 to
  // phi'(1) > 0 there is one zero. By false position, which may creep up on it from one side; so every third
  // trial halves.
  double low = 0.0, high = 1.0, part = 1.0, low_slope = slope_at_start;
  evaluate(false);
  double high_slope = descent();
  for (int i = 0; i < effort_.trials && high_slope > 0.0; ++i) {
    const double secant = low - low_slope * (high - low) / (high_slope - low_slope);
    const double next = i % 3 == 2 ? 0.5 * (low + high) : secant;
    velocity_ += (next - part) * direction_;
    part = next;
    evaluate(false);
    const double slope = descent();
    if (std::abs(slope) <= kFlat * -slope_at_start) return;
    (slope > 0.0 ? high : low) = next;
    (slope > 0.0 ? high_slope : low_slope) = slope;
  }
}

}  // namespace mrhi
