#pragma once

#include "collision/body_manifold.h"
#include "random_capsules.h"

namespace mrhi {

constexpr double kRounding = 1e-12;  // of lengths of some centimetres, over some dozens of operations [m]
const Shape kCan = Cylinder{0.02, 0.03};

inline Quaternion turn(double angle, const Vector3& axis) {
  return Quaternion(Eigen::AngleAxisd(angle, axis.normalized()));
}
inline Quaternion random_turn(Random& random) {
  return turn(random.between(0, 6.283), random.direction());
}

inline Pose at(double x, double y, double z) {
  return {{x, y, z}, Quaternion::Identity()};
}

inline double deepest(const Manifold& manifold) {
  double depth = -1e300;
  for (int i = 0; i < manifold.count; ++i) depth = std::max(depth, manifold.points[std::size_t(i)].depth);
  return depth;
}

/// A 1 m x 1 m plate, 20 mm thick, whose upper face is at z = 0.
inline Shape plate() {
  return Box{{0.5, 0.5, 0.01}};
}
inline Pose plate_pose() {
  return at(0, 0, -0.01);
}
inline Manifold on_plate(const Shape& shape, const Pose& pose, double margin = 0.001) {
  return body_manifold(shape, pose, plate(), plate_pose(), margin);
}

}  // namespace mrhi
