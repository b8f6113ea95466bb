#pragma once

#include <cstdint>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/body.h"

namespace mrhi {

/// State of a body. It stores momentum, so that free flight conserves it exactly.
struct BodyState {
  Pose pose;                                   ///< of the body frame (centre of mass) in world
  Vector3 linear_momentum = Vector3::Zero();   ///< [kg m/s], world axes
  Vector3 angular_momentum = Vector3::Zero();  ///< about the centre of mass [kg m^2/s], world axes
  Twist pushed;  ///< acceleration by contacts in the last step: warm start of the next [m/s^2, rad/s^2]
  bool appeared = false;  ///< was spawned or placed since the last step: hands that overlap it do not push it
};

/// Inverse inertia about the centre of mass in world axes [1/(kg m^2)].
Matrix3 world_inverse_inertia(const Body& body, const Quaternion& orientation);

/// Velocity that corresponds to the momenta.
Twist twist_of(const Body& body, const BodyState& state);

/// State at the start pose, at rest or with the body's start twist.
BodyState start_state(const Body& body);

/// Kinetic energy [J].
double kinetic_energy(const Body& body, const BodyState& state);

/// State of a joint. Its velocity is that of the bodies, whose momenta are the state. Units as in
/// scene/joint.h.
struct JointState {
  double position = 0.0;     ///< [rad]
  double anchor = 0.0;       ///< anchor of friction [rad]
  double pushed = 0.0;       ///< acceleration by forces in the last step: warm start of the next [rad/s^2]
  double effort = 0.0;       ///< of the joint's own forces in the last step [N m]
  double still = 0.0;        ///< time for which both its bodies have been still [s]
  std::uint8_t detent = 0;   ///< index in Detents::at of the present detent
  std::int8_t at_limit = 0;  ///< -1: at the lower one, 1: at the upper one
  bool latched = false;      ///< within the latch's capture range
};

}  // namespace mrhi
