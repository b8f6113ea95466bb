#pragma once

#include <cmath>

namespace mrhi {

/// Solves a contact problem for its velocity: Newton's method with the friction limits of the last iterate;
/// each iterate's problem is convex. A Problem has
///   restart()         puts the velocity back to the step's start
///   limit_friction()  renews Coulomb's limits at the velocity
///   assemble()        gradient and Hessian there
///   error(), scale()  impulse that is missing, impulses that act [N s]
///   find_direction()  towards the solution
///   move(part)        along the direction; move(-part) goes back
///   energy(), descent()  of the convex problem, and its slope along the direction [J]
template <typename Problem>
class Newton {
 public:
  explicit Newton(Problem& problem) : problem_(problem) {}

  void solve() {
    problem_.restart();
    for (int i = 0; i < kMaxIterations; ++i) {
      problem_.limit_friction();
      problem_.assemble();
      if (solved()) return;
      advance(i >= kUncheckedIterations);
    }
    solve_with_held_limits();
  }

 private:
  static constexpr int kMaxIterations = 40;
  static constexpr int kMaxHeldIterations = 60;
  static constexpr int kMaxLimits = 8;
  static constexpr int kMaxHalvings = 12;
  /// The first full steps need no check: they are exact while contacts neither open nor slip, and what is
  /// wrong with them shows in the next iterate.
  static constexpr int kUncheckedIterations = 2;
  static constexpr double kConverged = 1e-10;  // of the forces' impulse

  bool solved() const { return problem_.error() <= kConverged * problem_.scale() + 1e-18; }

  /// Where the limits keep chasing the velocity: they are held while the convex problem is solved to its end,
  /// then renewed. The solution for any limits is passive, so whenever this stops nothing is thrown.
  void solve_with_held_limits() {
    problem_.restart();
    for (int renewed = 0; renewed < kMaxLimits; ++renewed) {
      problem_.limit_friction();
      for (int i = 0; i < kMaxHeldIterations; ++i) {
        problem_.assemble();
        if (solved()) break;
        advance(true);
      }
    }
  }

  void advance(bool checked) {
    problem_.find_direction();
    if (!checked) return problem_.move(1.0);
    const double before = problem_.energy(), descent = problem_.descent();
    double part = 1.0;
    problem_.move(part);
    for (int i = 0; i < kMaxHalvings && problem_.energy() > before + 1e-4 * part * descent; ++i) {
      part *= 0.5;
      problem_.move(-part);
    }
  }

  Problem& problem_;
};

}  // namespace mrhi
