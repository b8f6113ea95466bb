#include "mr_hand_interaction/synthetic/scripted_motion.h"

#include <algorithm>
#include <cmath>

#include "../math/minimum_jerk.h"
#include "../math/rotation.h"
#include "../tracking/hand_anatomy.h"
#include "motions.h"
#include "mr_hand_interaction/synthetic/hand_skeleton.h"

namespace mrhi {
namespace {

constexpr double kScale = 1.05;
constexpr double kPalmWidth = 0.085;
constexpr double kPalmShare = 0.68;  // fraction of the distance from the wrist to the middle of the knuckles

/// Dimensions in degrees and millimetres, for a table as in anatomy.
struct Anatomy {
  const double (&bones)[kBonesPerFinger];  ///< metacarpal to distal; the thumb's first is empty, as Leap's
  double radius;
  Vector3 base;
  double metacarpal_yaw, metacarpal_pitch;  ///< towards the thumb, towards the palm
  double yaw, pitch, roll;                  ///< of the finger at zero angles
  std::array<double, kFingerJoints> lower, upper;
};

FingerSkeleton skeleton_of(const Anatomy& a) {
  FingerSkeleton finger;
  finger.base = 1e-3 * kScale * a.base;
  const Matrix3 metacarpal = turn_about(Vector3::UnitZ(), a.metacarpal_yaw * kDegree) *
                             turn_about(Vector3::UnitY(), a.metacarpal_pitch * kDegree);
  finger.knuckle = finger.base + metacarpal.col(0) * (1e-3 * kScale * a.bones[0]);
  finger.root = turn_about(Vector3::UnitZ(), a.yaw * kDegree) *
                turn_about(Vector3::UnitY(), a.pitch * kDegree) *
                turn_about(Vector3::UnitX(), a.roll * kDegree);
  for (std::size_t bone = 1; bone < kBonesPerFinger; ++bone) {
    finger.bones[bone - 1] = 1e-3 * kScale * a.bones[bone];
  }
  finger.radius = 1e-3 * a.radius;
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
  hand.fingers[0] =
      skeleton_of({anatomy::kBoneLengths[0], 9.4, {2, 26, -10}, 0, 0, 38, 18, -60, thumb_low, thumb_high});
  hand.fingers[1] = skeleton_of({anatomy::kBoneLengths[1], 9.0, {8, 19, 7}, 8, 8, 4, 0, 0, low, high});
  hand.fingers[2] = skeleton_of({anatomy::kBoneLengths[2], 8.8, {10, 8, 9}, 0, 8, 0, 0, 0, low, high});
  hand.fingers[3] = skeleton_of({anatomy::kBoneLengths[3], 8.4, {10, -3.5, 8}, -9, 7, -4, 0, 0, low, high});
  hand.fingers[4] = skeleton_of({anatomy::kBoneLengths[4], 7.4, {8, -15, 3}, -17, 4, -9, 0, 0, low, high});
  return hand;
}

float clamp_share(double value) {
  return static_cast<float>(std::min(1.0, std::max(0.0, value)));
}

/// Approximates Leap's values: flexion of the fingers, and distance between thumb and index tip.
void fill_strengths(const HandPosture& posture, HandJoints& hand) {
  const double bend = posture.block<2, 4>(kBaseFlexion, 1).sum() / 4.0;
  hand.grab_strength = clamp_share((bend - 60.0 * kDegree) / (120.0 * kDegree));
  const double aperture = (*hand.joints[0][4] - *hand.joints[1][4]).norm();
  hand.pinch_strength = clamp_share((0.080 - aperture) / 0.055);
}

/// Parabola through the postures at the fractions 0, via_share and 1 of the path.
HandPosture posture_between(const Keyframe& from, const Keyframe& to, double share) {
  const HandPosture straight = from.posture + share * (to.posture - from.posture);
  if (to.via_share <= 0.0) return straight;
  const double v = to.via_share;
  const HandPosture bow = to.via - from.posture - v * (to.posture - from.posture);
  return straight + share * (1.0 - share) / (v * (1.0 - v)) * bow;
}

/// Rotates position and orientation about the centre by the same fraction of the rotation between both ends.
Pose on_arc(const Keyframe& from, const Keyframe& to, double share) {
  const Quaternion turn = to.wrist.orientation * from.wrist.orientation.conjugate();
  const Quaternion part = Quaternion::Identity().slerp(share, turn);
  const Vector3 arm = from.wrist.position - *to.centre;
  return {*to.centre + part * arm, (part * from.wrist.orientation).normalized()};
}

}  // namespace

Pose mirrored(const Pose& wrist) {
  const Quaternion& q = wrist.orientation;
  const Quaternion half_turn(0.0, 0.0, 0.0, 1.0);
  return {Vector3(-wrist.position.x(), wrist.position.y(), wrist.position.z()),
          Quaternion(q.w(), q.x(), -q.y(), -q.z()) * half_turn};
}

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
  hand.palm_centre = wrist.position + kPalmShare * (knuckles - wrist.position);
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

HandPosture posture_of_degrees(const double (&degrees)[kFingerJoints][kFingers]) {
  using Rows = Eigen::Matrix<double, kFingerJoints, kFingers, Eigen::RowMajor>;
  return (M_PI / 180.0) * Rows(Eigen::Map<const Rows>(&degrees[0][0]));
}

HandPlace hand_at(const std::vector<Keyframe>& keys, double time) {
  const auto after = [](double t, const Keyframe& key) { return t < key.time; };
  const auto next = std::upper_bound(keys.begin(), keys.end(), time, after);
  if (next == keys.end()) return {keys.back().wrist, keys.back().posture};
  if (next == keys.begin()) return {keys.front().wrist, keys.front().posture};
  const Keyframe &from = *(next - 1), &to = *next;
  const double duration = to.time - from.time;
  const double t = (time - from.time) / duration;
  const double share = minimum_jerk(t);
  if (to.centre) return {on_arc(from, to, share), posture_between(from, to, share)};
  const Pose wrist{
      minimum_jerk(from.wrist.position, from.velocity, to.wrist.position, to.velocity, duration, t),
      from.wrist.orientation.slerp(share, to.wrist.orientation).normalized()};
  const HandPosture still = HandPosture::Zero();
  return {wrist,
          posture_between(from, to, share) + minimum_jerk(still, from.rate, still, to.rate, duration, t)};
}

Pose default_device_mount() {
  return {Vector3::Zero(), Quaternion(Eigen::AngleAxisd(M_PI / 2.0, Vector3::UnitX()))};
}

JointsFrame sample(const ScriptedMotion& motion, Side side, Nanoseconds time, const Pose& device_in_world) {
  JointsFrame frame;
  frame.stamp = time;
  const auto period = static_cast<Nanoseconds>(std::llround(1e9 * motion.period()));
  const Nanoseconds run = time / period;
  const double in_run = to_seconds(time - run * period);
  if (time < 0 || in_run > motion.run_time()) return frame;
  const auto [wrist, posture] = hand_at(motion.keyframes, in_run);
  const Pose in_world = side == Side::left ? mirrored(wrist) : wrist;
  frame.hands.push_back(hand_joints(human_hand(), side, device_in_world.inverse() * in_world, posture));
  frame.hands.back().id = static_cast<std::uint32_t>(run + 1);
  return frame;
}

}  // namespace mrhi
