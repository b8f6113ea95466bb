#include "fingertip_reach.h"

#include <Eigen/Dense>
#include <algorithm>

namespace mrhi {
namespace {

using Jacobian = Eigen::Matrix<double, 3, kFingerJoints>;
using JointMatrix = Eigen::Matrix<double, kFingerJoints, kFingerJoints>;

Vector3 tip(const FingerSkeleton& finger, const FingerAngles& angles) {
  return finger_joints(finger, angles)[4];
}

/// Central differences; a joint that cannot move (no range, or pressed against its limit) has no column.
Jacobian tip_jacobian(const FingerSkeleton& finger, const FingerAngles& angles, const Vector3& error) {
  constexpr double kStep = 1e-5;
  Jacobian jacobian = Jacobian::Zero();
  for (int joint = 0; joint < kFingerJoints; ++joint) {
    if (finger.lower[joint] == finger.upper[joint]) continue;
    FingerAngles ahead = angles, behind = angles;
    ahead[joint] += kStep;
    behind[joint] -= kStep;
    const Vector3 column = (tip(finger, ahead) - tip(finger, behind)) / (2.0 * kStep);
    const double wish = column.dot(error);
    const bool stuck = (angles[joint] >= finger.upper[joint] && wish > 0.0) ||
                       (angles[joint] <= finger.lower[joint] && wish < 0.0);
    if (!stuck) jacobian.col(joint) = column;
  }
  return jacobian;
}

}  // namespace

Reach reach(const FingerSkeleton& finger, const Vector3& target, const FingerAngles& preferred) {
  constexpr int kIterations = 200;
  constexpr double kDamping = 2e-3;     // [m]
  constexpr double kLongestStep = 0.2;  // [rad]
  constexpr double kPreferenceGain = 0.2;
  FingerAngles angles = preferred.cwiseMax(finger.lower).cwiseMin(finger.upper);
  for (int i = 0; i < kIterations; ++i) {
    const Vector3 error = target - tip(finger, angles);
    const Jacobian jacobian = tip_jacobian(finger, angles, error);
    const Matrix3 damped = jacobian * jacobian.transpose() + kDamping * kDamping * Matrix3::Identity();
    const Eigen::Matrix<double, kFingerJoints, 3> inverse = jacobian.transpose() * damped.inverse();
    // The wish for the preferred posture fades so that the last iterations are for the target alone.
    const double gain = i < kIterations / 2 ? kPreferenceGain : 0.0;
    FingerAngles change =
        inverse * error + (JointMatrix::Identity() - inverse * jacobian) * (gain * (preferred - angles));
    const double largest = change.cwiseAbs().maxCoeff();
    if (largest > kLongestStep) change *= kLongestStep / largest;
    const FingerAngles next = (angles + change).cwiseMax(finger.lower).cwiseMin(finger.upper);
    // An iteration depends on the angles and the gain alone: what has converged to the bit stays so.
    if (next == angles) i = i < kIterations / 2 ? kIterations / 2 - 1 : kIterations;
    angles = next;
  }
  return {angles, (target - tip(finger, angles)).norm()};
}

HandPosture place_fingertips(const HandSkeleton& skeleton, const Pose& wrist,
                             const std::vector<FingertipContact>& contacts, double gap,
                             const HandPosture& preferred, double* worst_error) {
  HandPosture posture = within_limits(skeleton, preferred);
  double worst = 0.0;
  for (const FingertipContact& contact : contacts) {
    const FingerSkeleton& finger = skeleton.fingers[static_cast<std::size_t>(contact.finger)];
    const double height = finger.radius + (gap < 0.0 ? -contact.depth : gap);
    const Vector3 target = wrist.to_local(contact.point + height * contact.normal);
    const Reach result = reach(finger, target, preferred.col(contact.finger));
    posture.col(contact.finger) = result.angles;
    worst = std::max(worst, result.error);
  }
  if (worst_error != nullptr) *worst_error = worst;
  return posture;
}

}  // namespace mrhi
