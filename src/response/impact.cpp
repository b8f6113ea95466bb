#include "impact.h"

#include <cmath>
#include <limits>

#include "mr_hand_interaction/collision/god_object.h"

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
