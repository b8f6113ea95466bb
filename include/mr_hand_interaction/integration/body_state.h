#pragma once

#include <cstdint>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/body.h"

namespace mrhi {

/// State of one body. It contains momenta instead of velocities, so that free flight conserves them bit for
/// bit.
struct BodyState {
  Pose pose;                                   ///< of the body frame (centre of mass) in world
  Vector3 linear_momentum = Vector3::Zero();   ///< [kg m/s], world axes
  Vector3 angular_momentum = Vector3::Zero();  ///< about the centre of mass [kg m^2/s], world axes
  Twist pushed;  ///< acceleration by contacts in the last step: warm start of the next [m/s^2, rad/s^2]
  bool appeared = false;  ///< spawned since the last step: hands that it overlaps do not push it
};

/// Inverse inertia about the centre of mass in world axes [1/(kg m^2)].
Matrix3 world_inverse_inertia(const Body& body, const Quaternion& orientation);

/// Velocity from the momenta.
Twist twist_of(const Body& body, const BodyState& state);

/// Initial state of a body: its start pose, with its start twist.
BodyState start_state(const Body& body);

/// Kinetic energy [J].
double kinetic_energy(const Body& body, const BodyState& state);

/// State of one joint. Its velocity follows from the bodies' momenta. Units as in scene/joint.h.
struct JointState {
  double position = 0.0;     ///< [rad]
  double anchor = 0.0;       ///< position held by friction [rad]
  double pushed = 0.0;       ///< acceleration in the last step: warm start of the next [rad/s^2]
  double effort = 0.0;       ///< the joint's own force in the last step: its reaction [N m]
  double still = 0.0;        ///< time for which its tree has been still [s]
  std::uint8_t detent = 0;   ///< index in Detents::at of the one that it is in
  std::int8_t at_limit = 0;  ///< -1 at the lower one, 1 at the upper one
  bool latched = false;      ///< within the latch's reach
};

}  // namespace mrhi
