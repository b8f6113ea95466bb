#include "spring_potential.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace mrhi {
namespace {

/// Integral of min(k q, limit) from 0 to q: energy of a spring that yields.
double yielding_energy(double stiffness, double stretch, double limit) {
  if (stiffness * stretch <= limit) return 0.5 * stiffness * stretch * stretch;
  return limit * stretch - 0.5 * limit * limit / stiffness;
}

/// Gauss and Legendre's rule of three points, exact for polynomials up to degree five.
template <typename Function>
double integral(double from, double to, Function function) {
  const double middle = 0.5 * (from + to), half = 0.5 * (to - from), off = std::sqrt(0.6) * half;
  return half / 9.0 * (5.0 * function(middle - off) + 8.0 * function(middle) + 5.0 * function(middle + off));
}

double push(const Spring<double>& spring, double rate) {
  const double deep = std::max(0.0, spring.depth - spring.ahead * rate);
  const double parting = std::min(std::max(rate, 0.0) * spring.fade, 1.0);
  double pressed, steepness;
  spring.press(deep, pressed, steepness);
  return spring.stiffness * pressed * (1.0 - parting * parting);
}

/// Depth at which the spring begins to give way.
double yielding_depth(const Spring<double>& spring) {
  if (spring.yields >= 0.5 * spring.pad) return spring.yields + 0.5 * spring.pad;
  return std::sqrt(2.0 * spring.yields * spring.pad);
}

/// Integral of the push from the rate up, until it is none any more: piece by piece, a polynomial each.
double push_energy(const Spring<double>& spring, double rate) {
  const auto rate_at = [&](double depth) { return (spring.depth - depth) / spring.ahead; };
  const double end = spring.fade > 0.0 ? std::min(rate_at(0.0), 1.0 / spring.fade) : rate_at(0.0);
  std::array<double, 4> kinks{rate_at(yielding_depth(spring)), rate_at(spring.pad), 0.0, end};
  std::sort(kinks.begin(), kinks.end());
  double energy = 0.0, from = rate;
  for (const double kink : kinks) {
    const double to = std::min(kink, end);
    if (to <= from) continue;
    energy += integral(from, to, [&](double x) { return push(spring, x); });
    from = to;
  }
  return energy;
}

}  // namespace

double potential(const Spring<double>& spring, const Triple<double>& u, double spin) {
  const double rate = u.dot(spring.normal);
  const Triple<double> drawn = spring.stretch + spring.ahead * (u - rate * spring.normal);
  const double turned = std::abs(spring.twist + spring.ahead * spin);
  return push_energy(spring, rate) +
         (yielding_energy(spring.stiffness, std::sqrt(drawn.dot(drawn)), spring.slip_limit) +
          yielding_energy(spring.twist_stiffness, turned, spring.twist_limit)) /
             spring.ahead;
}

}  // namespace mrhi
