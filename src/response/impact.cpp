#include "impact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "../collision/god_object.h"

namespace mrhi {

// An impulse p at r changes v by p / m and w by I^-1 (r x p), so the point at r by p / m + (I^-1 [r]x p) x r,
// which is p / m - [r]x I^-1 [r]x p.
Matrix3 collision_matrix(double inverse_mass, const Matrix3& world_inverse_inertia, const Vector3& r) {
  const Matrix3 arm = cross_matrix(r);
  return inverse_mass * Matrix3::Identity() - arm * world_inverse_inertia * arm;
}

void apply_impulse(const Vector3& impulse, const Vector3& point, BodyState& state) {
  state.linear_momentum += impulse;
  state.angular_momentum += (point - state.pose.position).cross(impulse);
}

Vector3 relative_velocity(const Contact& contact, const Body& body, const BodyState& state) {
  return contact.hand_velocity - object_velocity(twist_of(body, state), state.pose.position, contact.point);
}

double energy_gained(const Vector3& approach, const Vector3& given, const Vector3& after) {
  return -0.5 * given.dot(approach + after);
}

void keep_from_gaining(std::vector<TwoBlows>& strikes) {
  double least = 0.0, exchanged = 0.0;
  for (const TwoBlows& strike : strikes) {
    least += energy_gained(strike.approach, strike.least, strike.after_least);
    exchanged += strike.least.norm() * strike.approach.norm();
  }
  if (least > kNoGain * exchanged) {
    for (TwoBlows& strike : strikes) {
      strike.newtons = strike.least, strike.after_newtons = strike.after_least;
      strike.least.setZero(), strike.after_least = strike.approach;
    }
    least = 0.0;
  }
  // Impulses and velocities are linear in the share of Newton's, so the energy gained is a parabola of it.
  double linear = 0.0, square = 0.0;
  for (const TwoBlows& strike : strikes) {
    const Vector3 more = strike.newtons - strike.least, faster = strike.after_newtons - strike.after_least;
    linear -= 0.5 * (more.dot(strike.approach + strike.after_least) + strike.least.dot(faster));
    square -= 0.5 * more.dot(faster);
  }
  // Its zero in the form that does not cancel.
  const double root = std::sqrt(std::max(0.0, linear * linear - 4.0 * square * least));
  double share = 0.0;
  if (linear > 0.0)
    share = -2.0 * least / (linear + root);
  else if (square > 0.0)
    share = (root - linear) / (2.0 * square);
  share = least <= 0.0 ? std::clamp(share, 0.0, 1.0) : 0.0;
  for (TwoBlows& strike : strikes) strike.newtons = strike.least + share * (strike.newtons - strike.least);
}

double time_to_close(double gap, double rate, double acceleration) {
  constexpr double kNever = std::numeric_limits<double>::infinity();
  if (gap <= 0.0) return 0.0;
  // Zero of gap + rate t + a t^2 / 2 in the form that does not cancel.
  const double discriminant = rate * rate - 2.0 * acceleration * gap;
  if (discriminant < 0.0) return kNever;
  const double closing = -rate + std::sqrt(discriminant);
  return closing > 0.0 ? 2.0 * gap / closing : kNever;
}

}  // namespace mrhi
