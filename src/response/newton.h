#pragma once

#include <cmath>

namespace mrhi {

/// A way within a step that nobody sees: a body that is off by less has been solved for [m].
constexpr double kUnseenWay = 1e-9;

/// How long a Problem is worked on, at most.
struct Effort {
  int iterations = 40;       // with limits renewed in each
  int limits = 8;            // held after that, one after the other,
  int held_iterations = 60;  // for each of them
  int unchecked = 2;  // first steps: exact while contacts neither open nor slip, else the next one shows
  bool anew = true;   // from the step's start on, else from where the others have led
  int trials = 20;    // for the least energy along a direction
  double converged = 1e-7;  // when it is solved: error of the forces' impulse
};

/// Solves a contact problem for its velocity: Newton's method with the friction limits of the last iterate;
/// each iterate's problem is convex. A Problem has
///   restart()             puts the velocity back to the step's start; before, it is near the solution
///   evaluate(renew)       what acts at the velocity, with Coulomb's limits renewed there first or held
///   error_squared()       of the impulse that is missing [N^2 s^2]
///   scale()               impulses that act [N s]
///   unseen()              an impulse that moves nothing by what could be seen [N s]
///   factorise()           the Hessian of the convex problem there
///   find_direction()      towards the solution, by the last Hessian
///   move(part)            along the direction; move(-part) goes back
///   kTrustsLastStep       whether the last step's effect may go unmeasured
///   effort()              how long to try
///   energy(), descent()   of the convex problem, and its slope along the direction [J]
///
/// The problem is g(v) = M (v - v*) - h J' f(v; L) = 0 with g the gradient of a convex, once differentiable
/// E(v) while the limits L are held, and H = M + h J' K J, positive definite by its M:
///
///     H d = -g(v),     v <- v + s d,     s = 1 where it will do
///
/// Forces have kinks where contacts open and slip, so H is one of the generalised Hessians there and this is
/// a semismooth Newton method (Qi & Sun 1993). Once contacts have their states and all stick, forces are
/// linear in v but for the fade and the pulp, and one step is as good as exact; where some slip and their
/// limits are renewed, what H leaves out of them (dL/dN, see Spring::respond) makes convergence linear.
/// Hessians are kept while the error falls fast (the chord method; Kelley 1995, ch. 5).
template <typename Problem>
class Newton {
 public:
  explicit Newton(Problem& problem) : problem_(problem), effort_(problem.effort()) {}

  /// True if the forces and the velocity found agree.
  bool solve() {
    double last = 0.0;
    for (int i = 0; i < effort_.iterations; ++i) {
      problem_.evaluate(true);
      if (solved()) return true;
      const double error = problem_.error_squared();
      const bool near = i > 0 && error < kFast * kFast * last;
      last = error;
      const bool last_step = near ? error_below(kTrusted) : i == 0 && error_below(kTrustedAtOnce);
      if (Problem::kTrustsLastStep && last_step) {
        advance(false, near);
        return false;
      }
      advance(i >= effort_.unchecked && !near, near);
    }
    solve_with_held_limits();
    return false;
  }

 private:
  /// The least energy along a direction is found where the slope is this part of what it began with.
  static constexpr double kFlat = 0.01;
  /// A step that leaves less than this part of the error was taken where the Hessian hardly changes.
  static constexpr double kFast = 0.05;
  /// Fast convergence takes an error of this size below Effort::converged in one more step,
  static constexpr double kTrusted = 1e-5;
  /// and so does the first one, by a Hessian of its own, where the last step has led this near: what it
  /// leaves goes with the square (measured: 4e-11 of 3e-5).
  static constexpr double kTrustedAtOnce = 1e-4;
  /// Below this error the energy is rounding and no guide any more; of the forces' impulse.
  static constexpr double kFine = 1e-5;
  /// Less than this part of the forces' impulse is rounding of what goes into it.
  static constexpr double kRounding = 1e-12;

  bool error_below(double part) const {
    // The last is for bodies on which nothing acts: of nothing no part is reached [N s].
    const double most = part * problem_.scale() + 1e-18;
    return problem_.error_squared() <= most * most;
  }
  /// The momenta at the step's end are what the forces found make of those at its start, so that what is
  /// missing here costs no momentum. But it goes into them whole: where forces are large and the step is
  /// long, a small part of their impulse is a way that can be seen.
  bool solved() const {
    if (!error_below(effort_.converged)) return false;
    const double unseen = problem_.unseen();
    return problem_.error_squared() <= unseen * unseen || error_below(kRounding);
  }

  /// Where the limits keep chasing the velocity: they are held while the convex problem is solved to its end,
  /// then renewed. The solution for any limits is passive, so whenever this stops nothing is thrown.
  void solve_with_held_limits() {
    if (effort_.anew) problem_.restart();
    // With limits held the problem is that of Tresca's friction, which has one solution; a fixed point of
    // `solve, renew` solves Coulomb's (Panagiotopoulos 1975, Haslinger 1983). That it comes to one is
    // proven for small coefficients only: hence the bound on how often.
    for (int renewed = 0; renewed < effort_.limits; ++renewed) {
      problem_.evaluate(true);
      for (int i = 0; i < effort_.held_iterations && !solved(); ++i) {
        advance(true, false);
        problem_.evaluate(false);
      }
    }
  }

  void advance(bool checked, bool same_hessian) {
    if (!same_hessian) problem_.factorise();
    problem_.find_direction();
    if (!checked || error_below(kFine)) return problem_.move(1.0);
    // Armijo's condition, E(v + d) <= E(v) + 1e-4 g.d, where g.d = -d'H d < 0 (Nocedal & Wright, Numerical
    // Optimization, 2006, 3.1).
    const double before = problem_.energy(), descent = problem_.descent();
    problem_.move(1.0);
    if (problem_.energy() > before + 1e-4 * descent) go_back(descent);
  }

  /// From the end of a step that went too far to about the least energy along it, where the slope, which
  /// grows along the line, passes zero. To halve the step until it will do is not enough: a light object
  /// between stiff fingers goes to and fro across the rim of the friction cone then and hardly advances.
  void go_back(double descent) {
    // phi(s) = E(v + s d), phi' = g(v + s d).d, which grows with s as E is convex: from phi'(0) = `descent`
    // < 0 to phi'(1) > 0 there is one zero. By false position, which may creep up on it from one side; so
    // every third trial halves.
    double low = 0.0, high = 1.0, part = 1.0, low_slope = descent;
    problem_.evaluate(false);
    double high_slope = problem_.descent();
    for (int i = 0; i < effort_.trials && high_slope > 0.0; ++i) {
      const double secant = low - low_slope * (high - low) / (high_slope - low_slope);
      const double next = i % 3 == 2 ? 0.5 * (low + high) : secant;
      problem_.move(next - part);
      part = next;
      problem_.evaluate(false);
      const double slope = problem_.descent();
      if (std::abs(slope) <= kFlat * -descent) return;
      (slope > 0.0 ? high : low) = next;
      (slope > 0.0 ? high_slope : low_slope) = slope;
    }
  }

  Problem& problem_;
  const Effort effort_;
};

}  // namespace mrhi
