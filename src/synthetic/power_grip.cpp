#include <algorithm>

#include "motions.h"

namespace mrhi {
namespace {

constexpr double kPalmDepth = 0.003;    // of the palm beyond the bar's surface [m]
constexpr double kDepth = 0.005;        // of the closed fingers, likewise [m]
constexpr double kGap = 0.001;          // of the fingers before they touch [m]
constexpr double kStep = M_PI / 360.0;  // of a joint that closes [rad]

/// Distance of the line through `bar` along y from the segment, seen along the line [m].
double distance(const Vector3& bar, const Vector3& start, const Vector3& end) {
  const auto flat = [](const Vector3& v) { return Vector3(v.x(), 0.0, v.z()); };
  const Vector3 from = flat(start - bar), along = flat(end - start);
  const double length = along.squaredNorm();
  const double share = length > 0.0 ? std::clamp(-from.dot(along) / length, 0.0, 1.0) : 0.0;
  return (from + share * along).norm();
}

/// Smallest distance from the line of the bones that a joint moves [m].
double distance(const FingerSkeleton& finger, const FingerAngles& angles, FingerJoint joint,
                const Vector3& bar) {
  const auto joints = finger_joints(finger, angles);
  double smallest = 1.0;
  for (auto bone = static_cast<std::size_t>(joint); bone < kBonesPerFinger; ++bone)
    smallest = std::min(smallest, distance(bar, joints[bone], joints[bone + 1]));
  return smallest;
}

/// Flexes joint by joint, from the palm outwards, until bones are that far from the bar's axis.
FingerAngles close_round(const FingerSkeleton& finger, FingerAngles angles, const Vector3& bar, double off) {
  static_assert(kBaseFlexion == 1 && kMiddleFlexion == 2 && kEndFlexion == 3, "a joint moves its bone");
  for (const FingerJoint joint : {kBaseFlexion, kMiddleFlexion, kEndFlexion}) {
    for (FingerAngles next = angles; next[joint] <= finger.upper[joint]; next[joint] += kStep) {
      if (distance(finger, next, joint, bar) < off) break;
      angles = next;
    }
  }
  return angles;
}

HandPosture close_round(const HandPosture& open, const Vector3& bar, double radius, double gap) {
  HandPosture closed = open;
  for (int f = 0; f < kFingers; ++f) {
    const FingerSkeleton& finger = human_hand().fingers[static_cast<std::size_t>(f)];
    closed.col(f) = close_round(finger, open.col(f), bar, radius + finger.radius + gap);
  }
  return closed;
}

}  // namespace

PowerGrip::PowerGrip(double radius) {
  const HandJoints flat = hand_joints(human_hand(), Side::right, {}, flat_posture());
  bar = *flat.palm_centre + Vector3(0.2, 0.0, -0.15) * human_hand().palm_width;
  bar.z() -= radius - kPalmDepth;
  open = posture_of_degrees(
      {{40, 0, 0, 0, 0}, {-25, -5, -5, -5, -5}, {0, 25, 25, 25, 25}, {0, 15, 15, 15, 15}, {50}});
  near = close_round(open, bar, radius, kGap);
  closed = close_round(open, bar, radius, -kDepth);
}

}  // namespace mrhi
