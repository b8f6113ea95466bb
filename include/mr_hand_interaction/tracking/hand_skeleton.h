#pragma once

#include <Eigen/Core>
#include <array>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Rows of FingerAngles. Base, middle and end are MCP, PIP and DIP of a finger; CMC, MCP and IP of the thumb.
enum FingerJoint { kAbduction, kBaseFlexion, kMiddleFlexion, kEndFlexion, kOpposition, kFingerJoints };

/// Joint angles of one finger [rad]. A finger abducts towards the thumb, the thumb away from the palm.
/// Flexion bends towards the palm. Opposition rotates the thumb about its own axis to face the fingers.
using FingerAngles = Eigen::Matrix<double, kFingerJoints, 1>;

/// Joint angles of a hand, a column per finger, thumb to little.
using HandPosture = Eigen::Matrix<double, kFingerJoints, kFingers>;

/// One finger of a right hand in the hand's frame: origin at the wrist, x towards the fingers, y towards the
/// thumb, z out of the back of the hand [m].
struct FingerSkeleton {
  Vector3 base;     ///< carpal end of the metacarpal
  Vector3 knuckle;  ///< distal end of the metacarpal; == base for the thumb, as in Leap's model
  Matrix3 root;     ///< orientation at zero angles: x along the finger, y the flexion axis
  std::array<double, kBonesPerFinger - 1> bones;  ///< lengths outward from the knuckle
  double radius;
  FingerAngles lower, upper;  ///< limits of the joints
};

struct HandSkeleton {
  std::array<FingerSkeleton, kFingers> fingers;
  double palm_width;
};

/// Bone lengths of Buryanov & Kotiuk (2010) times one scale; joint limits from textbooks of anatomy.
const HandSkeleton& human_hand();

/// j0..j4 of one finger in the right hand's frame.
std::array<Vector3, 5> finger_joints(const FingerSkeleton& finger, const FingerAngles& angles);

/// Clamps each angle to its limits.
HandPosture within_limits(const HandSkeleton& skeleton, const HandPosture& posture);

/// The hand as a tracker would report it. `wrist` is the pose of the hand's frame; a left hand is mirrored in
/// y of that frame.
HandJoints hand_joints(const HandSkeleton& skeleton, Side side, const Pose& wrist,
                       const HandPosture& posture);

/// Angles in degrees: a row for each joint, with a column for each finger; missing columns are 0.
HandPosture posture_of_degrees(const double (&degrees)[kFingerJoints][kFingers]);

/// Half closed, as at rest; flat with the fingers together; index extended from a loose fist.
HandPosture relaxed_posture();
HandPosture flat_posture();
HandPosture pointing_posture();

}  // namespace mrhi
