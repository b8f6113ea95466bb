#pragma once

#include <cstdint>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/body.h"

namespace mrhi {

/// What changes about one body. Momentum is the state, so that free flight conserves it to the last bit.
struct BodyState {
  Pose pose;                                   ///< of the body frame (centre of mass) in world
  Vector3 linear_momentum = Vector3::Zero();   ///< [kg m/s], world axes
  Vector3 angular_momentum = Vector3::Zero();  ///< about the centre of mass [kg m^2/s], world axes
  Twist pushed;  ///< acceleration by what touched it in the last step: near it lies the next [m/s^2, rad/s^2]
  bool appeared = false;  ///< was put there since the last step: hands that it overlaps do not push it
};

/// Inverse inertia about the centre of mass in world axes [1/(kg m^2)].
Matrix3 world_inverse_inertia(const Body& body, const Quaternion& orientation);

/// Velocity that belongs to the momenta.
Twist twist_of(const Body& body, const BodyState& state);

/// At rest, or with the body's start twist, at its start pose.
BodyState start_state(const Body& body);

/// Kinetic energy [J].
double kinetic_energy(const Body& body, const BodyState& state);

/// What changes about one joint. Its velocity is that of the bodies, whose momenta are the state. Units as in
/// scene/joint.h.
struct JointState {
  double position = 0.0;     ///< [rad]
  double anchor = 0.0;       ///< place that friction holds [rad]
  double pushed = 0.0;       ///< acceleration by what acted in the last step: near it lies the next [rad/s^2]
  double effort = 0.0;       ///< that the joint's own forces gave in the last step: its reaction [N m]
  double still = 0.0;        ///< for how long its tree has been as good as at rest [s]
  std::uint8_t detent = 0;   ///< index in Detents::at of the one that it is in
  std::int8_t at_limit = 0;  ///< -1 at the lower one, 1 at the upper one
  bool latched = false;      ///< within the latch's reach
};

}  // namespace mrhi
