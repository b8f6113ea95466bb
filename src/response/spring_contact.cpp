#include "spring_contact.h"

namespace mrhi {
namespace {

/// Integral of min(k q, limit) from 0 to q: energy of a spring that yields.
double yielding_energy(double stiffness, double stretch, double limit) {
  if (stiffness * stretch <= limit) return 0.5 * stiffness * stretch * stretch;
  return limit * stretch - 0.5 * limit * limit / stiffness;
}

}  // namespace

double SpringContact::potential(const Vector3& u, double spin) const {
  const double rate = normal.dot(u);
  // Integral of the push from the rate up: where it is released, that of a line times a line.
  const auto released = [this](double from, double to) {
    const auto antiderivative = [this](double x) {
      const double r = 1.0 / kReleaseSpeed;
      return stiffness * (depth * x - 0.5 * (ahead + depth * r) * x * x + ahead * r * x * x * x / 3.0);
    };
    return to > from ? antiderivative(to) - antiderivative(from) : 0.0;
  };
  const double gone = depth / ahead;  // the rate at which the surfaces just part
  double energy = released(std::max(rate, 0.0), std::min(gone, kReleaseSpeed));
  if (rate < std::min(gone, 0.0) || (rate < 0.0 && gone > 0.0)) {
    const double from = depth_ahead(rate), to = depth_ahead(0.0);
    energy += 0.5 * stiffness * (from * from - to * to) / ahead;
  }
  energy += yielding_energy(stiffness, stretch_ahead(u).norm(), slip_limit) / ahead;
  energy += yielding_energy(twist_stiffness, std::abs(twist + ahead * spin), twist_limit) / ahead;
  return energy;
}

SpringContact::Settled SpringContact::settle(const Vector3& u, double spin) const {
  const Response response = evaluate(u, spin);
  Settled settled{response.force, before, Vector3::Zero(), twist};
  const double wanted = stiffness * stretch_ahead(u).norm();
  const bool sticks = wanted <= (before == Friction::sticking ? 1.0 : kStickAgain) * slip_limit;
  settled.friction = sticks ? Friction::sticking : Friction::slipping;
  // What slides is what the spring and its damping, in line with the friction, do not follow.
  const double followed = step / ahead;
  if (!sticks && response.push > 0.0) {
    const Vector3 along = u - normal.dot(u) * normal;
    const Vector3 tangential = response.force + response.push * normal;
    const double rim = std::min(1.0, dynamic_friction * response.push / tangential.norm());
    const Vector3 kept = stretch + followed * (rim * tangential / stiffness - stretch);
    settled.slide = stretch + step * along - kept;
  }
  if (twist_stiffness > 0.0) settled.twist += followed * (response.torque / twist_stiffness - twist);
  return settled;
}

}  // namespace mrhi
