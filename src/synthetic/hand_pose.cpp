#include <cmath>

#include "motions.h"

namespace mrhi {

Pose hand_pose(const Vector3& wrist, const Vector3& fingers, const Vector3& dorsal) {
  Matrix3 axes;
  axes.col(0) = fingers.normalized();
  axes.col(1) = dorsal.cross(fingers).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return {wrist, Quaternion(axes)};
}

Pose wrist_for_index_tip(const Vector3& tip, const Pose& direction, const HandPosture& posture) {
  const Vector3 in_hand = finger_joints(human_hand().fingers[1], posture.col(1))[4];
  return {tip - direction.orientation * in_hand, direction.orientation};
}

Quaternion turn(double degrees, const Vector3& axis) {
  return Quaternion(Eigen::AngleAxisd(degrees * M_PI / 180.0, axis));
}

HandPosture posture_of_degrees(const HandPosture& degrees) {
  return (M_PI / 180.0) * degrees;
}

}  // namespace mrhi
