#include "mr_hand_interaction/tracking/hand_skeleton.h"

#include <algorithm>

#include "../math/rotation.h"
#include "hand_anatomy.h"

namespace mrhi {
namespace {

constexpr double kScale = 1.05;
constexpr double kPalmWidth = 0.085;
constexpr double kPalmRatio = 0.68;  // fraction of the distance from the wrist to the middle of the knuckles

/// Where a finger begins, and its limits [mm, degrees].
struct Root {
  Vector3 base;
  double metacarpal_yaw, metacarpal_pitch;  ///< towards the thumb, towards the palm
  double yaw, pitch, roll;                  ///< of the finger at zero angles
  std::array<double, kFingerJoints> lower, upper;
};

FingerSkeleton skeleton_of(std::size_t number, const Root& a) {
  const auto& bones = anatomy::kBoneLengths[number];
  FingerSkeleton finger;
  finger.base = 1e-3 * kScale * a.base;
  const Matrix3 metacarpal = turn_about(Vector3::UnitZ(), a.metacarpal_yaw * kDegree) *
                             turn_about(Vector3::UnitY(), a.metacarpal_pitch * kDegree);
  finger.knuckle = finger.base + metacarpal.col(0) * (1e-3 * kScale * bones[0]);
  finger.root = turn_about(Vector3::UnitZ(), a.yaw * kDegree) *
                turn_about(Vector3::UnitY(), a.pitch * kDegree) *
                turn_about(Vector3::UnitX(), a.roll * kDegree);
  for (std::size_t bone = 1; bone < kBonesPerFinger; ++bone) {
    finger.bones[bone - 1] = 1e-3 * kScale * bones[bone];
  }
  finger.radius = 1e-3 * anatomy::kFingerRadii[number];
  for (int joint = 0; joint < kFingerJoints; ++joint) {
    finger.lower[joint] = a.lower[joint] * kDegree;
    finger.upper[joint] = a.upper[joint] * kDegree;
  }
  return finger;
}

HandSkeleton make_human_hand() {
  const std::array<double, kFingerJoints> low{{-20, -25, 0, 0, 0}}, high{{20, 90, 110, 80, 0}};
  const std::array<double, kFingerJoints> thumb_low{{-20, -30, -10, -15, 0}},
      thumb_high{{55, 40, 60, 80, 50}};
  HandSkeleton hand;
  hand.palm_width = kPalmWidth;
  hand.fingers[0] = skeleton_of(0, {{2, 26, -10}, 0, 0, 38, 18, -60, thumb_low, thumb_high});
  hand.fingers[1] = skeleton_of(1, {{8, 19, 7}, 8, 8, 4, 0, 0, low, high});
  hand.fingers[2] = skeleton_of(2, {{10, 8, 9}, 0, 8, 0, 0, 0, low, high});
  hand.fingers[3] = skeleton_of(3, {{10, -3.5, 8}, -9, 7, -4, 0, 0, low, high});
  hand.fingers[4] = skeleton_of(4, {{8, -15, 3}, -17, 4, -9, 0, 0, low, high});
  return hand;
}

float clamped_ratio(double value) {
  return static_cast<float>(std::min(1.0, std::max(0.0, value)));
}

/// Approximates Leap's values: flexion of the fingers, and distance between thumb and index tip.
void fill_strengths(const HandPosture& posture, HandJoints& hand) {
  const double bend = posture.block<2, 4>(kBaseFlexion, 1).sum() / 4.0;
  hand.grab_strength = clamped_ratio((bend - 60.0 * kDegree) / (120.0 * kDegree));
  const double aperture = (*hand.joints[0][4] - *hand.joints[1][4]).norm();
  hand.pinch_strength = clamped_ratio((0.080 - aperture) / 0.055);
}

}  // namespace

const HandSkeleton& human_hand() {
  static const HandSkeleton hand = make_human_hand();
  return hand;
}

std::array<Vector3, 5> finger_joints(const FingerSkeleton& finger, const FingerAngles& angles) {
  std::array<Vector3, 5> joints;
  joints[0] = finger.base;
  joints[1] = finger.knuckle;
  Matrix3 bone = finger.root * turn_about(Vector3::UnitZ(), angles[kAbduction]) *
                 turn_about(Vector3::UnitY(), angles[kBaseFlexion]) *
                 turn_about(Vector3::UnitX(), -angles[kOpposition]);
  joints[2] = joints[1] + finger.bones[0] * bone.col(0);
  bone = bone * turn_about(Vector3::UnitY(), angles[kMiddleFlexion]);
  joints[3] = joints[2] + finger.bones[1] * bone.col(0);
  bone = bone * turn_about(Vector3::UnitY(), angles[kEndFlexion]);
  joints[4] = joints[3] + finger.bones[2] * bone.col(0);
  return joints;
}

HandPosture within_limits(const HandSkeleton& skeleton, const HandPosture& posture) {
  HandPosture limited = posture;
  for (int finger = 0; finger < kFingers; ++finger) {
    const FingerSkeleton& limits = skeleton.fingers[finger];
    limited.col(finger) = posture.col(finger).cwiseMax(limits.lower).cwiseMin(limits.upper);
  }
  return limited;
}

HandJoints hand_joints(const HandSkeleton& skeleton, Side side, const Pose& wrist,
                       const HandPosture& posture) {
  const Vector3 mirror(1.0, side == Side::left ? -1.0 : 1.0, 1.0);
  HandJoints hand;
  hand.id = 1;
  hand.side = side;
  hand.wrist = wrist.position;
  hand.palm_width = static_cast<float>(skeleton.palm_width);
  Vector3 knuckles = Vector3::Zero();
  for (std::size_t finger = 0; finger < kFingers; ++finger) {
    const auto joints = finger_joints(skeleton.fingers[finger], posture.col(static_cast<int>(finger)));
    for (std::size_t j = 0; j < joints.size(); ++j)
      hand.joints[finger][j] = wrist * mirror.cwiseProduct(joints[j]);
    hand.finger_width[finger] = static_cast<float>(2.0 * skeleton.fingers[finger].radius);
    if (finger > 0) knuckles += 0.25 * *hand.joints[finger][1];
  }
  hand.palm_centre = wrist.position + kPalmRatio * (knuckles - wrist.position);
  fill_strengths(posture, hand);
  return hand;
}

HandPosture relaxed_posture() {
  return posture_of_degrees(
      {{10, 2, 0, -2, -4}, {5, 25, 28, 30, 32}, {15, 30, 34, 36, 36}, {20, 18, 20, 22, 22}, {10}});
}

HandPosture flat_posture() {
  return posture_of_degrees({{-5, 0, 0, 0, 2}, {-5, 4, 4, 4, 4}, {5, 6, 6, 6, 6}, {5, 4, 4, 4, 4}});
}

HandPosture pointing_posture() {
  return posture_of_degrees({{20}, {20, 8, 68, 70, 72}, {30, 8, 95, 95, 92}, {35, 5, 55, 55, 55}, {25}});
}

HandPosture posture_of_degrees(const double (&degrees)[kFingerJoints][kFingers]) {
  using Rows = Eigen::Matrix<double, kFingerJoints, kFingers, Eigen::RowMajor>;
  return (M_PI / 180.0) * Rows(Eigen::Map<const Rows>(&degrees[0][0]));
}

}  // namespace mrhi
