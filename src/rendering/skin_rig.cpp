#include "skin_rig.h"

#include "mr_hand_interaction/synthetic/hand_skeleton.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {
namespace {

constexpr double kDegree = M_PI / 180.0;

HandPosture rest_posture() {
  HandPosture posture = HandPosture::Zero();
  posture.row(kAbduction) << 0.0, 6.0, 1.0, -5.0, -10.0;
  return kDegree * posture;
}

/// z is as near to `back` as x allows. y = back x x, z = x x y: what is left of `back` across x.
Matrix3 axes_along(const Vector3& x, const Vector3& back) {
  Matrix3 axes;
  axes.col(0) = x.normalized();
  axes.col(1) = back.cross(axes.col(0)).normalized();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

SkinBone bone_along(const Capsule& capsule, const Matrix3& axes) {
  return {capsule.start, axes, (capsule.end - capsule.start).norm(), capsule.radius};
}

RestHand make_rest_hand() {
  RestHand rest;
  rest.hand = complete_hand(hand_joints(human_hand(), Side::right, Pose{}, rest_posture()), Pose{});
  for (int finger = 0; finger < kFingers; ++finger) {
    const Vector3 back = human_hand().fingers[static_cast<std::size_t>(finger)].root.col(2);
    for (int bone = first_bone(finger); bone < kBonesPerFinger; ++bone) {
      const auto index = static_cast<std::size_t>(capsule_index(finger, bone));
      const Capsule& capsule = rest.hand.capsules[index];
      rest.rig[index] =
          bone_along(capsule, axes_along(capsule.end - capsule.start, bone == 0 ? Vector3::UnitZ() : back));
      if (bone > 0) rest.rig[static_cast<std::size_t>(bend_index(finger, bone))] = rest.rig[index];
    }
  }
  rest.rig[kWristBone] = {rest.hand.wrist, rest.hand.palm.orientation.toRotationMatrix(),
                          rest.hand.palm_width, rest.hand.palm_width};
  return rest;
}

/// The rest hand's axes for a hand of this side. M A M with M = diag(1, -1, 1): mirrored and mirrored back it
/// is a rotation again.
Matrix3 mirrored(Matrix3 axes, Side side) {
  if (side == Side::left) axes.row(1) *= -1.0, axes.col(1) *= -1.0;
  return axes;
}

class Poser {
 public:
  explicit Poser(const Hand& hand) : hand_(hand), rest_(rest_hand().rig) {
    rig_[kWristBone] = {hand.wrist, hand.palm.orientation.toRotationMatrix(), hand.palm_width,
                        hand.palm_width};
  }

  SkinRig pose() {
    for (int finger = 0; finger < kFingers; ++finger) {
      int parent = kWristBone;
      for (int bone = first_bone(finger); bone < kBonesPerFinger; ++bone) {
        const int index = capsule_index(finger, bone);
        turn(index, parent, bone > 0 ? bend_index(finger, bone) : -1);
        parent = index;
      }
    }
    if (hand_.side == Side::left) {
      for (SkinBone& bone : rig_) bone.axes.col(1) *= -1.0;
    }
    return rig_;
  }

 private:
  Matrix3 rest_axes(int index) const {
    return mirrored(rest_[static_cast<std::size_t>(index)].axes, hand_.side);
  }

  /// From the parent as it is now, by the turn that the rest hand has between the two, then by the least
  /// rotation that brings x onto the bone: no twist about the bone, which the tracker does not tell. The bend
  /// has half of that rotation. Folded back by 180 degrees the least rotation is not unique; no joint goes so
  /// far.
  void turn(int index, int parent, int bend) {
    const auto i = static_cast<std::size_t>(index);
    const Capsule& capsule = hand_.capsules[i];
    const Matrix3 unbent =
        rig_[static_cast<std::size_t>(parent)].axes * rest_axes(parent).transpose() * rest_axes(index);
    const Quaternion turned = Quaternion::FromTwoVectors(unbent.col(0), capsule.end - capsule.start);
    rig_[i] = bone_along(capsule, turned * unbent);
    if (bend < 0) return;
    SkinBone& half = rig_[static_cast<std::size_t>(bend)];
    half = rig_[i];
    half.axes = Quaternion::Identity().slerp(0.5, turned) * unbent;
  }

  const Hand& hand_;
  const SkinRig& rest_;
  SkinRig rig_;
};

}  // namespace

const RestHand& rest_hand() {
  static const RestHand rest = make_rest_hand();
  return rest;
}

bool has_whole_skin(const Hand& hand) {
  for (int i = 0; i < kPhalanges; ++i) {
    if (i != capsule_index(0, 0) && !hand.has(i)) return false;
  }
  return hand.palm_width > 0.0;
}

SkinRig pose_rig(const Hand& hand) {
  return Poser(hand).pose();
}

}  // namespace mrhi
