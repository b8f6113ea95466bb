#pragma once

#include <Eigen/Core>
#include <array>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Rows of FingerAngles. Base, middle and end are MCP, PIP and DIP of a finger; CMC, MCP and IP of the thumb.
enum FingerJoint { kAbduction, kBaseFlexion, kMiddleFlexion, kEndFlexion, kOpposition, kFingerJoints };

/// Joint angles of one finger [rad]. Abduction of a finger is towards the thumb, of the thumb away from the
/// palm; flexion bends towards the palm; opposition turns the thumb about its own axis to face the fingers.
using FingerAngles = Eigen::Matrix<double, kFingerJoints, 1>;

/// Joint angles of a hand, a column per finger, thumb to little.
using HandPosture = Eigen::Matrix<double, kFingerJoints, kFingers>;

/// One finger of a right hand in the hand's frame: origin at the wrist, x to the fingers, y to the thumb's
/// side, z out of the back of the hand [m].
struct FingerSkeleton {
  Vector3 base;     ///< metacarpal's carpal end
  Vector3 knuckle;  ///< its far end; == base for the thumb, as Leap has it
  Matrix3 root;     ///< orientation at zero angles: x along the finger, y the flexion axis
  std::array<double, kBonesPerFinger - 1> bones;  ///< lengths outward from the knuckle
  double radius;
  FingerAngles lower, upper;  ///< limits of the joints
};

struct HandSkeleton {
  std::array<FingerSkeleton, kFingers> fingers;
  double palm_width;
};

/// Bone lengths of Buryanov & Kotiuk (2010) times one scale; joint limits as in textbooks of anatomy.
const HandSkeleton& human_hand();

/// j0..j4 of one finger in the right hand's frame.
std::array<Vector3, 5> finger_joints(const FingerSkeleton& finger, const FingerAngles& angles);

/// Each angle within its limits.
HandPosture within_limits(const HandSkeleton& skeleton, const HandPosture& posture);

/// The hand as a tracker would report it. `wrist` is the pose of the hand's frame; a left hand is the mirror
/// image in y of that frame.
HandJoints hand_joints(const HandSkeleton& skeleton, Side side, const Pose& wrist,
                       const HandPosture& posture);

/// Half closed as a hand hangs; flat with the fingers together; index stretched out from a loose fist.
HandPosture relaxed_posture();
HandPosture flat_posture();
HandPosture pointing_posture();

}  // namespace mrhi
