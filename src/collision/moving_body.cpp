#include "moving_body.h"

namespace mrhi {

/// w = R I^-1 R^T L, with L in world and I in the body's frame: momentum is the state.
MovingBody::MovingBody(const Body& of, const BodyState& state, const Vector3& gravity)
    : body(of),
      pose(state.pose),
      rotation(state.pose.orientation.toRotationMatrix()),
      acceleration(gravity),
      appeared(state.appeared) {
  if (of.fixed) {
    acceleration.setZero();
    return;
  }
  twist.linear = state.linear_momentum / of.mass;
  const Vector3 momentum = rotation.transpose() * state.angular_momentum;
  twist.angular = rotation * (of.inverse_inertia * momentum);
}

///     x(t) = x + v t + g t^2 / 2,   R(t) = exp(t [w]x) R
/// w is kept for the step, though a body that spins about none of its main axes tumbles: good enough for
/// where it first touches; flight itself is integrated elsewhere.
Pose MovingBody::at(double time) const {
  const double angle = twist.angular.norm() * time;
  Pose result{pose.position + time * (twist.linear + 0.5 * time * acceleration), pose.orientation};
  if (angle > 0.0) {
    result.orientation = Quaternion(Eigen::AngleAxisd(angle, twist.angular.normalized())) * pose.orientation;
  }
  return result;
}

/// Eq. 7: v + g t + w x r.
Vector3 MovingBody::velocity(double time, const Vector3& arm) const {
  return twist.linear + time * acceleration + twist.angular.cross(arm);
}

}  // namespace mrhi
