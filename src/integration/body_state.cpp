#include "mr_hand_interaction/integration/body_state.h"

namespace mrhi {

// I_w^-1 = R I^-1 R'.
Matrix3 world_inverse_inertia(const Body& body, const Quaternion& orientation) {
  const Matrix3 rotation = orientation.toRotationMatrix();
  return rotation * body.inverse_inertia * rotation.transpose();
}

// w = R I^-1 R' L. Momenta are what is kept, since nothing changes them in flight; velocities follow from
// them.
// By the quaternion rather than R: a body's momentum is turned into its axes and the result back, two turns
// of a vector where I_w^-1 takes two products of matrices.
Twist twist_of(const Body& body, const BodyState& state) {
  if (body.fixed) return {};
  const Quaternion& q = state.pose.orientation;
  const Vector3 body_momentum = q.conjugate() * state.angular_momentum;
  return {state.linear_momentum / body.mass, q * (body.inverse_inertia * body_momentum)};
}

BodyState start_state(const Body& body) {
  BodyState state;
  state.pose = body.start;
  if (body.fixed) return state;
  const Quaternion& q = state.pose.orientation;
  state.linear_momentum = body.mass * body.start_twist.linear;
  state.angular_momentum = q * (body.inertia * (q.conjugate() * body.start_twist.angular));
  return state;
}

// T = (p.v + L.w) / 2.
double kinetic_energy(const Body& body, const BodyState& state) {
  if (body.fixed) return 0.0;
  const Twist twist = twist_of(body, state);
  return 0.5 * (state.linear_momentum.dot(twist.linear) + state.angular_momentum.dot(twist.angular));
}

}  // namespace mrhi
