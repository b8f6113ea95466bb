#pragma once

#include "mr_hand_interaction/integration/body_state.h"
#include "mr_hand_interaction/math.h"

namespace mrhi {

/// A body through one step: where it is at its start, and how it goes on if nothing touches it.
struct MovingBody {
  MovingBody(const Body& of, const BodyState& state, const Vector3& gravity);

  Pose at(double time) const;  ///< [s] from the step's start
  /// Velocity, at that time, of its point that is `arm` off its centre [m/s].
  Vector3 velocity(double time, const Vector3& arm) const;

  /// x_world = R x + p, and back by R^T: the matrix is made once, where a quaternion would be turned into it
  /// for every point.
  Vector3 to_world(const Vector3& local) const { return rotation * local + pose.position; }
  Vector3 to_local(const Vector3& world) const { return rotation.transpose() * (world - pose.position); }
  Capsule to_local(const Capsule& world) const {
    return {to_local(world.start), to_local(world.end), world.radius};
  }

  const Body& body;
  const Pose& pose;      ///< at the step's start
  Matrix3 rotation;      ///< of that pose
  Twist twist;           ///< at the step's start
  Vector3 acceleration;  ///< zero for a fixture [m/s^2]
  bool appeared;         ///< as this step began
};

}  // namespace mrhi
