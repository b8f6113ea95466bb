#include <gtest/gtest.h>

#include "mr_hand_interaction/synthetic/scripted_motion.h"
#include "mr_hand_interaction/tracking/hand_skeleton.h"

namespace mrhi {
namespace {

const Pose kHome{};

double bone_length(const HandJoints& hand, std::size_t finger, std::size_t bone) {
  return (*hand.joints[finger][bone + 1] - *hand.joints[finger][bone]).norm();
}

TEST(HandSkeleton, bone_lengths_are_those_of_the_anatomical_table_times_one_scale) {
  // Buryanov & Kotiuk 2010 [mm]; the thumb's metacarpal is its bone 1, as Leap has it.
  const double table[5][4] = {{0.0, 46.22, 31.57, 21.67},
                              {68.12, 39.78, 22.38, 15.82},
                              {64.60, 44.63, 26.33, 17.40},
                              {58.00, 41.37, 25.65, 17.30},
                              {53.69, 32.74, 18.11, 15.96}};
  const HandJoints hand = hand_joints(human_hand(), Side::right, kHome, relaxed_posture());
  const double scale = bone_length(hand, 2, 1) / table[2][1];
  EXPECT_GT(scale, 0.9e-3);
  EXPECT_LT(scale, 1.2e-3);
  for (std::size_t finger = 0; finger < 5; ++finger) {
    for (std::size_t bone = 0; bone < 4; ++bone) {
      // Rounding of a chain of rotations.
      EXPECT_NEAR(bone_length(hand, finger, bone), scale * table[finger][bone], 1e-12)
          << finger << ' ' << bone;
    }
  }
}

TEST(HandSkeleton, fingers_bend_towards_the_palm) {
  for (int finger = 0; finger < kFingers; ++finger) {
    const FingerSkeleton& bones = human_hand().fingers[static_cast<std::size_t>(finger)];
    FingerAngles straight = FingerAngles::Zero(), bent = straight;
    bent[kMiddleFlexion] = bent[kEndFlexion] = 0.5;
    EXPECT_LT(finger_joints(bones, bent)[4].z(), finger_joints(bones, straight)[4].z() - 0.005) << finger;
  }
}

TEST(HandSkeleton, the_thumb_is_on_the_left_of_a_right_hand_seen_from_its_back) {
  const HandJoints right = hand_joints(human_hand(), Side::right, kHome, flat_posture());
  const HandJoints left = hand_joints(human_hand(), Side::left, kHome, flat_posture());
  EXPECT_GT(right.joints[0][4]->y(), right.joints[1][4]->y());
  EXPECT_LT(left.joints[0][4]->y(), left.joints[1][4]->y());
}

TEST(HandSkeleton, a_left_hand_is_the_mirror_image_of_a_right_one) {
  const HandJoints right = hand_joints(human_hand(), Side::right, kHome, relaxed_posture());
  const HandJoints left = hand_joints(human_hand(), Side::left, kHome, relaxed_posture());
  for (std::size_t finger = 0; finger < 5; ++finger) {
    for (std::size_t j = 0; j < 5; ++j) {
      const Vector3 image = right.joints[finger][j]->cwiseProduct(Vector3(1.0, -1.0, 1.0));
      EXPECT_EQ(image, *left.joints[finger][j]);
    }
  }
}

TEST(HandSkeleton, open_fingers_neither_cross_nor_overlap) {
  for (const HandPosture& posture : {flat_posture(), relaxed_posture()}) {
    const HandJoints hand = hand_joints(human_hand(), Side::right, kHome, posture);
    for (std::size_t finger = 1; finger < 4; ++finger) {
      for (std::size_t j = 1; j < 5; ++j) {
        EXPECT_GT(hand.joints[finger][j]->y(), hand.joints[finger + 1][j]->y()) << finger << ' ' << j;
        // Skin touches skin where the distance is the mean of the widths; a millimetre of squeeze is natural.
        const double widths =
            0.5 * static_cast<double>(*hand.finger_width[finger] + *hand.finger_width[finger + 1]);
        EXPECT_GT((*hand.joints[finger][j] - *hand.joints[finger + 1][j]).norm(), widths - 0.001);
      }
    }
  }
}

TEST(HandSkeleton, the_tracker_takes_it_and_finds_the_palm_where_it_was_put) {
  const Pose wrist{{0.1, -0.2, 0.3}, Quaternion(0.8, 0.2, -0.3, 0.4).normalized()};
  for (const Side side : {Side::right, Side::left}) {
    const HandJoints joints = hand_joints(human_hand(), side, wrist, relaxed_posture());
    EXPECT_EQ(defect(joints), "");
    const Hand hand = complete_hand(joints, Pose{});
    // The palm's axes come from the joints alone; the knuckles are not quite square to the hand's frame: 15
    // degrees.
    EXPECT_GT((hand.palm.orientation * Vector3::UnitX()).dot(wrist.orientation * Vector3::UnitX()), 0.966);
    EXPECT_GT((hand.palm.orientation * Vector3::UnitZ()).dot(wrist.orientation * Vector3::UnitZ()), 0.966);
  }
}

TEST(HandSkeleton, named_postures_are_within_the_limits_of_the_joints) {
  for (const HandPosture& posture : {flat_posture(), relaxed_posture(), pointing_posture()}) {
    EXPECT_EQ(within_limits(human_hand(), posture), posture);
  }
}

}  // namespace
}  // namespace mrhi
