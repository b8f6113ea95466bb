#include "spring_potential.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

/// Integral of min(k q, limit) from 0 to q: energy of a spring that yields.
double yielding_energy(double stiffness, double stretch, double limit) {
  if (stiffness * stretch <= limit) return 0.5 * stiffness * stretch * stretch;
  return limit * stretch - 0.5 * limit * limit / stiffness;
}

/// Integral of the push from the rate up, until it is none any more.
double push_energy(double stiffness, double depth, double ahead, double rate) {
  // Where the push is released, that of a line times a parabola.
  const auto antiderivative = [=](double x) {
    const double r = 1.0 / (kReleaseSpeed * kReleaseSpeed), x2 = x * x;
    return stiffness * (depth * x - 0.5 * ahead * x2 - depth * r * x * x2 / 3.0 + 0.25 * ahead * r * x2 * x2);
  };
  const double gone = depth / ahead;  // the rate at which the surfaces just part
  const double from = std::max(rate, 0.0), to = std::min(gone, kReleaseSpeed);
  double energy = to > from ? antiderivative(to) - antiderivative(from) : 0.0;
  if (rate < std::min(gone, 0.0) || (rate < 0.0 && gone > 0.0)) {
    const double deep = std::max(0.0, depth - ahead * rate), at_rest = std::max(0.0, depth);
    energy += 0.5 * stiffness * (deep * deep - at_rest * at_rest) / ahead;
  }
  return energy;
}

}  // namespace

double potential(const Spring<double>& spring, const Triple<double>& u, double spin) {
  const double rate = u.dot(spring.normal);
  const Triple<double> drawn = spring.stretch + spring.ahead * (u - rate * spring.normal);
  const double turned = std::abs(spring.twist + spring.ahead * spin);
  return push_energy(spring.stiffness, spring.depth, spring.ahead, rate) +
         (yielding_energy(spring.stiffness, std::sqrt(drawn.dot(drawn)), spring.slip_limit) +
          yielding_energy(spring.twist_stiffness, turned, spring.twist_limit)) /
             spring.ahead;
}

}  // namespace mrhi
