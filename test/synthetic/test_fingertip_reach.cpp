#include <gtest/gtest.h>

#include "synthetic/motions.h"

namespace mrhi {
namespace {

const FingerSkeleton& bones(int finger) {
  return human_hand().fingers[static_cast<std::size_t>(finger)];
}

TEST(FingertipReach, reaches_wherever_the_finger_can_be) {
  for (int finger = 0; finger < kFingers; ++finger) {
    const FingerAngles lower = bones(finger).lower, range = bones(finger).upper - lower;
    for (double share : {0.3, 0.5, 0.7}) {
      const Vector3 target = finger_joints(bones(finger), lower + share * range)[4];
      const FingerSolution result = solve_finger(bones(finger), target, relaxed_posture().col(finger));
      // The damping leaves an error that shrinks with every iteration; a micrometre is far below any tracker.
      EXPECT_LT(result.error, 1e-6) << "finger " << finger << ", share " << share;
    }
  }
}

TEST(FingertipReach, keeps_to_the_limits_and_says_how_far_it_is_off) {
  const Vector3 too_far(0.5, 0.0, 0.0);
  const FingerSolution result = solve_finger(bones(1), too_far, relaxed_posture().col(1));
  EXPECT_TRUE((result.angles.array() <= bones(1).upper.array()).all());
  EXPECT_TRUE((result.angles.array() >= bones(1).lower.array()).all());
  EXPECT_NEAR(result.error, (too_far - finger_joints(bones(1), result.angles)[4]).norm(), 1e-12);
  EXPECT_GT(result.error, 0.2);
}

TEST(FingertipReach, changes_nothing_where_the_preferred_posture_already_reaches) {
  const FingerAngles preferred = relaxed_posture().col(2);
  const FingerSolution result = solve_finger(bones(2), finger_joints(bones(2), preferred)[4], preferred);
  EXPECT_LT((result.angles - preferred).norm(), 1e-9);  // rounding
}

TEST(FingertipReach, places_the_skin_of_the_tips_at_the_gap_or_the_depth) {
  const Pose wrist{{0.01, 0.02, 0.03}, Quaternion(0.9, 0.1, 0.2, 0.3).normalized()};
  const Vector3 normal = wrist.orientation * Vector3(-1.0, 0.0, 0.0);
  const Vector3 point = wrist * Vector3(0.13, 0.01, -0.05);
  const Grasp grasp{wrist, {{2, point, normal, 0.004}}, relaxed_posture(), 0.0, Vector3::UnitZ()};
  for (const double gap : {0.01, 0.0, -1.0}) {
    const HandPosture posture = grasp.posture(gap);
    const Vector3 tip = wrist * finger_joints(bones(2), posture.col(2))[4];
    const double height = normal.dot(tip - point) - bones(2).radius;
    EXPECT_NEAR(height, gap < 0.0 ? -0.004 : gap, 1e-6);
    EXPECT_EQ(posture.col(4), relaxed_posture().col(4));
  }
}

}  // namespace
}  // namespace mrhi
