#include "mr_hand_interaction/integration/free_flight.h"

#include <algorithm>
#include <cmath>

namespace mrhi {
namespace {

/// Quaternion of the rotation vector `theta` [rad]; the series keeps full precision near zero.
Quaternion exponential(const Vector3& theta) {
  const double angle_squared = theta.squaredNorm();
  double cosine, half_sinc;  // cos(a/2) and sin(a/2)/a
  if (angle_squared < 1e-4) {
    cosine = 1.0 - angle_squared / 8.0 + angle_squared * angle_squared / 384.0;
    half_sinc = 0.5 - angle_squared / 48.0 + angle_squared * angle_squared / 3840.0;
  } else {
    const double angle = std::sqrt(angle_squared);
    cosine = std::cos(0.5 * angle);
    half_sinc = std::sin(0.5 * angle) / angle;
  }
  return Quaternion(cosine, half_sinc * theta.x(), half_sinc * theta.y(), half_sinc * theta.z());
}

/// dexp^-1 of so(3), truncated after the second commutator: enough for order four.
Vector3 inverse_differential(const Vector3& theta, const Vector3& rate) {
  const Vector3 commutator = theta.cross(rate);
  return rate + 0.5 * commutator + theta.cross(commutator) / 12.0;
}

/// Body angular velocity when the body has turned by `theta` (body axes) from where its momentum was
/// `momentum`.
Vector3 angular_velocity(const Body& body, const Vector3& momentum, const Vector3& theta) {
  return body.inverse_inertia * (exponential(theta).conjugate() * momentum);
}

/// Below this turn the second-order step is exact to rounding [rad].
constexpr double kSmallTurn = 1e-5;

/// Rotation vector, body axes, that Euler's equations turn the body by within `step`.
Vector3 rotation_over(const Body& body, const Vector3& momentum, double step) {
  const Vector3 k1 = step * (body.inverse_inertia * momentum);
  const Vector3 t2 = 0.5 * k1;
  if (k1.squaredNorm() < kSmallTurn * kSmallTurn)
    return k1 + step * (body.inverse_inertia * momentum.cross(t2));
  const Vector3 k2 = step * inverse_differential(t2, angular_velocity(body, momentum, t2));
  const Vector3 t3 = 0.5 * k2;
  const Vector3 k3 = step * inverse_differential(t3, angular_velocity(body, momentum, t3));
  const Vector3 k4 = step * inverse_differential(k3, angular_velocity(body, momentum, k3));
  return (k1 + 2.0 * k2 + 2.0 * k3 + k4) / 6.0;
}

/// The fourth-order step loses its order beyond about a third of a radian, so fast spins take several.
constexpr double kLargestTurn = 0.3;  // [rad]

void turn(const Body& body, const Vector3& angular_momentum, double step, Quaternion& orientation) {
  const Vector3 rate = body.inverse_inertia * (orientation.conjugate() * angular_momentum);
  const int turns = 1 + static_cast<int>(std::min(rate.norm() * step / kLargestTurn, 1000.0));
  for (int i = 0; i < turns; ++i) {
    const Vector3 momentum = orientation.conjugate() * angular_momentum;
    orientation = (orientation * exponential(rotation_over(body, momentum, step / turns))).normalized();
  }
}

}  // namespace

void free_flight(const Body& body, const Vector3& gravity, double step, BodyState& state) {
  if (body.fixed) return;
  const Vector3 velocity = state.linear_momentum / body.mass;
  state.pose.position += step * velocity + (0.5 * step * step) * gravity;
  state.linear_momentum += (body.mass * step) * gravity;

  if (state.angular_momentum == Vector3::Zero()) return;
  turn(body, state.angular_momentum, step, state.pose.orientation);
}

}  // namespace mrhi
