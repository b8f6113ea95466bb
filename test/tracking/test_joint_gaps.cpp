#include <gtest/gtest.h>

#include "adult_hand.h"
#include "mr_hand_interaction/tracking/hand_merger.h"
#include "support/fixtures.h"

namespace mrhi {
namespace {

using testing::at;

constexpr std::size_t kTipJoint = 4;

/// The hand on its way: it turns and goes on, as a stiff whole.
Pose way(double t) {
  return {Vector3(0.2 * t, 0.1, -0.3 * t),
          Quaternion(Eigen::AngleAxisd(2.0 * t, Vector3(1, 2, 3).normalized()))};
}

HandJoints joints_at(double t, Side side = Side::right) {
  HandJoints hand = adult_hand(side);
  hand.wrist = way(t) * *hand.wrist;
  for (auto& finger : hand.joints)
    for (auto& joint : finger) joint = way(t) * *joint;
  return hand;
}

class JointGapsOf : public ::testing::Test {
 protected:
  HandJoints filled(double t, const HandJoints& hand) {
    JointsFrame frame{at(t), {hand}};
    gaps_.fill(frame);
    return frame.hands.at(0);
  }

  JointGaps gaps_;
};

TEST_F(JointGapsOf, a_hand_without_gaps_keeps_its_bits) {
  for (int i = 0; i < 10; ++i) {
    const HandJoints hand = joints_at(0.03 * i);
    EXPECT_EQ(filled(0.03 * i, hand).joints, hand.joints);
  }
}

// The registration is exact for a stiff hand: what is left is rounding.
TEST_F(JointGapsOf, what_is_lost_goes_on_with_the_hand_for_the_hold_time_and_no_longer) {
  filled(0.0, joints_at(0.0));
  const double longest = to_seconds(JointGaps::kLongest);
  for (double t = 0.01; t < 2.0 * longest; t += 0.01) {
    HandJoints hand = joints_at(t);
    const HandJoints whole = hand;
    hand.joints[1][kTipJoint].reset();
    hand.joints[3][1].reset();
    hand.wrist.reset();
    const HandJoints found = filled(t, hand);
    EXPECT_EQ(found.joints[1][kTipJoint].has_value(), t < longest + 0.005) << t;
    EXPECT_EQ(found.wrist.has_value(), t < longest + 0.005) << t;
    if (t > longest) continue;
    EXPECT_LT((*found.joints[1][kTipJoint] - *whole.joints[1][kTipJoint]).norm(), 1e-12);
    EXPECT_LT((*found.joints[3][1] - *whole.joints[3][1]).norm(), 1e-12);
    EXPECT_LT((*found.wrist - *whole.wrist).norm(), 1e-12);
  }
}

TEST_F(JointGapsOf, what_was_never_seen_stays_missing) {
  HandJoints hand = joints_at(0.0);
  hand.joints[2][0].reset();
  filled(0.0, hand);
  hand.joints[1][kTipJoint].reset();
  const HandJoints found = filled(0.01, hand);
  EXPECT_FALSE(found.joints[2][0]);
  EXPECT_TRUE(found.joints[1][kTipJoint]);
}

TEST_F(JointGapsOf, two_joints_do_not_say_where_the_others_are) {
  filled(0.0, joints_at(0.0));
  HandJoints hand = joints_at(0.01);
  const auto wrist = hand.wrist;
  for (auto& finger : hand.joints)
    for (std::size_t j = 0; j < finger.size(); ++j) finger[j].reset();
  hand.joints[2][1] = joints_at(0.01).joints[2][1];
  const HandJoints found = filled(0.01, hand);
  EXPECT_EQ(found.wrist, wrist);
  EXPECT_EQ(found.joints, hand.joints);
}

TEST_F(JointGapsOf, the_other_hand_fills_nothing) {
  filled(0.0, joints_at(0.0, Side::left));
  HandJoints hand = joints_at(0.01, Side::right);
  hand.joints[1][kTipJoint].reset();
  EXPECT_FALSE(filled(0.01, hand).joints[1][kTipJoint]);
}

TEST_F(JointGapsOf, another_stream_begins_anew) {
  filled(5.0, joints_at(0.0));
  HandJoints hand = joints_at(0.0);
  hand.joints[1][kTipJoint].reset();
  EXPECT_FALSE(filled(1.0, hand).joints[1][kTipJoint]);
}

TEST_F(JointGapsOf, what_is_not_finite_is_not_kept) {
  filled(0.0, joints_at(0.0));
  HandJoints hand = joints_at(0.01);
  hand.joints[1][kTipJoint]->x() = INFINITY;
  EXPECT_NE(defect(filled(0.01, hand)), "");
  hand = joints_at(0.02);
  hand.joints[1][kTipJoint].reset();
  EXPECT_LT((*filled(0.02, hand).joints[1][kTipJoint] - *joints_at(0.02).joints[1][kTipJoint]).norm(), 1e-12);
}

}  // namespace
}  // namespace mrhi
