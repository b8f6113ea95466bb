#pragma once

#include <variant>
#include <vector>

#include "mr_hand_interaction/math.h"
#include "mr_hand_interaction/scene/shape.h"

namespace mrhi::benchmark {

/// A free body or a fixture, centre of mass at its origin. SI units, world axes.
struct BodySpec {
  std::variant<Sphere, Box, Mesh> shape;  ///< worlds with meshes exclude engines without moving meshes
  double mass = 0.1;                      ///< [kg]
  Vector3 inertia = Vector3::Ones();      ///< principal moments, body axes [kg m^2]
  Pose pose;
  Twist twist;
  bool fixed = false;
};

/// A part of the hand: capsules with constant relative poses. Only the hand moves it.
struct KinematicSpec {
  std::vector<Capsule> capsules;  ///< in its own frame
  Pose pose;                      ///< at the start
};

/// Joint between a body and the world that leaves rotation about one axis.
struct HingeSpec {
  std::size_t body = 0;
  Vector3 anchor = Vector3::Zero();  ///< on the axis, world
  Vector3 axis = Vector3::UnitZ();   ///< unit, world
  double friction = 0.0;             ///< Coulomb's [N m]
};

/// World for every engine. One friction coefficient and one restitution apply to all surfaces.
struct World {
  Vector3 gravity = Vector3::Zero();  ///< [m/s^2]
  double friction = 0.8;
  double restitution = 0.0;
  bool sleep = true;  ///< bodies at rest may sleep
  std::vector<BodySpec> bodies;
  std::vector<KinematicSpec> kinematics;
  std::vector<HingeSpec> hinges;  ///< exclude engines without hinges
};

/// A homogeneous box; `size` holds whole edge lengths [m].
inline BodySpec box(const Vector3& size, double mass, const Pose& pose = {}, const Twist& twist = {}) {
  const Vector3 squares = size.cwiseProduct(size);
  BodySpec body;
  body.shape = Box{0.5 * size};
  body.mass = mass;
  body.inertia = mass / 12.0 * (Vector3::Constant(squares.sum()) - squares);
  body.pose = pose;
  body.twist = twist;
  return body;
}

/// A homogeneous ball.
inline BodySpec ball(double radius, double mass, const Pose& pose = {}, const Twist& twist = {}) {
  BodySpec body;
  body.shape = Sphere{radius};
  body.mass = mass;
  body.inertia = Vector3::Constant(0.4 * mass * radius * radius);
  body.pose = pose;
  body.twist = twist;
  return body;
}

/// A fixture whose top is the plane z = 0.
inline BodySpec floor_slab() {
  BodySpec slab = box({4.0, 4.0, 0.2}, 1.0, {Vector3(0, 0, -0.1), Quaternion::Identity()});
  slab.fixed = true;
  return slab;
}

/// Constant velocity that takes `from` to `to` in `seconds`.
inline Twist twist_between(const Pose& from, const Pose& to, double seconds) {
  const Eigen::AngleAxisd turn(to.orientation * from.orientation.conjugate());
  return {(to.position - from.position) / seconds, turn.angle() / seconds * turn.axis()};
}

}  // namespace mrhi::benchmark
