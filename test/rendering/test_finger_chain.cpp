#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "rendering/renderer.h"
#include "support/finger_angles.h"
#include "support/posed_hand.h"

namespace mrhi {
namespace {

constexpr double kDegree = M_PI / 180.0;
/// Bones are not quite in one plane, which the angle between two of them shows [rad].
constexpr double kAside = 0.005;

Hand bent_hand(Side side = Side::right) {
  const Pose wrist{Vector3(0.1, -0.2, 0.3),
                   Quaternion(Eigen::AngleAxisd(0.8, Vector3(1.0, 2.0, -1.0).normalized()))};
  return testing::posed_hand(relaxed_posture(), wrist, side);
}

class Offsets {
 public:
  HandOffset next() {
    HandOffset offset;
    for (int i = 0; i < 3; ++i) offset.shift[i] = 0.05 * spread_(random_);
    for (FingerOffset& finger : offset.fingers)
      for (int i = 0; i < 4; ++i) finger[i] = 0.5 * spread_(random_);
    return offset;
  }

 private:
  std::mt19937 random_{5};
  std::uniform_real_distribution<double> spread_{-1.0, 1.0};
};

Hand placed(const Hand& tracked, const HandOffset& offset) {
  HandChain chain;
  chain.begin(tracked);
  Hand hand = tracked;
  chain.place(offset, hand);
  return hand;
}

TEST(FingerChain, keeps_bone_lengths_and_joints_whatever_the_offset) {
  Offsets offsets;
  const Hand tracked = bent_hand();
  for (int i = 0; i < 100; ++i) {
    const Hand hand = placed(tracked, offsets.next());
    for (int finger = 0; finger < kFingers; ++finger) {
      for (int bone = finger == 0 ? 1 : 0; bone < kBonesPerFinger; ++bone) {
        const auto c = static_cast<std::size_t>(capsule_index(finger, bone));
        const Capsule &from = tracked.capsules[c], &to = hand.capsules[c];
        EXPECT_NEAR((to.end - to.start).norm(), (from.end - from.start).norm(), 1e-15);
        if (bone < 3) {
          EXPECT_EQ(to.end, hand.capsules[c + 1].start);
        }
      }
    }
  }
}

TEST(FingerChain, turns_each_joint_by_its_offset) {
  Offsets offsets;
  for (const Side side : {Side::right, Side::left}) {
    const Hand tracked = bent_hand(side);
    for (int i = 0; i < 100; ++i) {
      const HandOffset offset = offsets.next();
      const Hand hand = placed(tracked, offset);
      for (int finger = 1; finger < kFingers; ++finger) {
        const FingerOffset turned =
            testing::finger_angles(hand, finger) - testing::finger_angles(tracked, finger);
        const FingerOffset wanted = offset.fingers[static_cast<std::size_t>(finger)];
        EXPECT_LT((turned - wanted).abs().maxCoeff(), kAside) << finger;
      }
    }
  }
}

// The root of a thumb counts from its rest pose, of which its own bend is no part.
TEST(FingerChain, a_thumb_turned_to_its_limits_is_there_sideways_too) {
  const JointLimits limits = joint_limits(0);
  for (const Side side : {Side::right, Side::left}) {
    const Hand tracked = bent_hand(side);
    const FingerChain thumb(tracked, 0, Vector3::Zero());
    for (int corner = 0; corner < 4; ++corner) {
      HandOffset offset;
      for (int i = 0; i < 2; ++i)
        offset.fingers[0][i] = (corner >> i & 1) != 0 ? thumb.upper()[i] : thumb.lower()[i];
      const FingerOffset angles = testing::finger_angles(placed(tracked, offset), 0);
      for (int i = 0; i < 2; ++i)
        EXPECT_NEAR(angles[i], (corner >> i & 1) != 0 ? limits.upper[i] : limits.lower[i], 1e-9);
    }
  }
}

TEST(FingerChain, points_as_it_was_shown_where_the_palm_has_turned_since) {
  Offsets offsets;
  const Hand tracked = bent_hand();
  Hand turned = tracked;
  turned.palm.orientation = turned.palm.orientation * Quaternion(Eigen::AngleAxisd(0.1, Vector3(1, 0, 0)));
  for (int i = 0; i < 100; ++i) {
    const HandOffset wanted = offsets.next();
    for (int finger = 0; finger < kFingers; ++finger) {
      const auto f = static_cast<std::size_t>(finger);
      FingerChain before(tracked, finger, Vector3::Zero()), now(turned, finger, Vector3::Zero());
      const FingerOffset kept = wanted.fingers[f].max(before.lower()).min(before.upper());
      Hand shown = tracked, again = turned;
      before.place(tracked, kept, wanted.shift, shown);
      const FingerOffset like = now.like(shown, before);
      if ((like == now.lower()).any() || (like == now.upper()).any()) continue;
      now.place(turned, like, Vector3::Zero(), again);
      EXPECT_LT(
          (testing::bone_direction(again, finger, 1) - testing::bone_direction(shown, finger, 1)).norm(),
          1e-9);
    }
  }
}

TEST(FingerChain, its_gradient_is_the_slope) {
  constexpr double kStep = 1e-6;
  Offsets offsets;
  const Hand tracked = bent_hand();
  const Vector3 normal = Vector3(0.3, -0.5, 0.8).normalized();
  for (int finger = 0; finger < kFingers; ++finger) {
    const auto f = static_cast<std::size_t>(finger);
    const HandOffset offset = offsets.next();
    for (int bone = 1; bone < kBonesPerFinger; ++bone) {
      const auto height = [&](const HandOffset& at) {
        return normal.dot(placed(tracked, at)
                              .capsules[static_cast<std::size_t>(capsule_index(finger, bone))]
                              .axis_point(0.7));
      };
      HandChain chain;
      chain.begin(tracked);
      Hand hand = tracked;
      chain.place(offset, hand);
      const Vector3 point =
          hand.capsules[static_cast<std::size_t>(capsule_index(finger, bone))].axis_point(0.7);
      const FingerOffset gradient = chain.finger(finger).gradient(bone, point, normal);
      for (int i = 0; i < 4; ++i) {
        HandOffset more = offset, less = offset;
        more.fingers[f][i] += kStep;
        less.fingers[f][i] -= kStep;
        EXPECT_NEAR(gradient[i], (height(more) - height(less)) / (2.0 * kStep), 1e-9);
      }
    }
  }
}

TEST(FingerChain, stops_at_the_limits_and_where_it_was_tracked_beyond_them) {
  HandPosture posture = relaxed_posture();
  posture(kMiddleFlexion, 1) = 130.0 * kDegree;  // beyond 115
  const Hand tracked = testing::posed_hand(posture, Pose());
  const FingerChain index(tracked, 1, Vector3::Zero()), middle(tracked, 2, Vector3::Zero());
  EXPECT_EQ(index.upper()[2], 0.0);
  EXPECT_NEAR(index.lower()[2], -135.0 * kDegree, 3.0 * kDegree);
  const FingerOffset angles = testing::finger_angles(tracked, 2);
  EXPECT_NEAR(middle.upper()[0], 95.0 * kDegree - angles[0], 1e-9);
  EXPECT_NEAR(middle.lower()[3], -20.0 * kDegree - angles[3], 1e-9);
}

TEST(FingerChain, without_a_proximal_phalanx_it_is_shifted_by_itself) {
  Hand tracked;
  tracked.capsules[static_cast<std::size_t>(capsule_index(1, 3))] = {Vector3::Zero(), Vector3(0.02, 0, 0),
                                                                     0.008};
  HandOffset offset;
  offset.fingers[1] = {0.01, 0.02, 0.03, 0.0};
  const Capsule distal = placed(tracked, offset).capsules[static_cast<std::size_t>(capsule_index(1, 3))];
  EXPECT_EQ(distal.start, Vector3(0.01, 0.02, 0.03));
  EXPECT_LT((distal.end - Vector3(0.03, 0.02, 0.03)).norm(), 1e-15);
}

constexpr Nanoseconds kFrame = 8'333'333;
constexpr double kTurned = 0.1;  // [rad]

double angle(const Quaternion& turn) {
  return turn.angularDistance(Quaternion::Identity());
}

HandOffset lagging(double turned) {
  const Quaternion turn(Eigen::AngleAxisd(turned, Vector3(1, 2, 2) / 3.0));
  HandOffset offset;
  offset.lag = {turn, turn};
  return offset;
}

TEST(ReturnHome, a_palm_that_lags_takes_a_fingertip_back_by_no_more_than_is_seen_as_a_jump) {
  const PalmLag left = lag_returning(lagging(kTurned), kFrame);
  // 0.4 mm in a frame: at 0.15 m from the palm's position, and at 0.1 m from a finger's root.
  EXPECT_NEAR(kTurned - angle(left.whole), 0.0004 / 0.15, 1e-9);
  EXPECT_NEAR(kTurned - angle(left.frame), 0.0004 / 0.1, 1e-9);
}

TEST(ReturnHome, a_small_lag_decays_in_a_twentieth_of_a_second_and_ends) {
  const PalmLag left = lag_returning(lagging(0.01), kFrame);
  EXPECT_NEAR(angle(left.frame), 0.01 * std::exp(-8.333333e-3 / 0.05), 1e-9);
  EXPECT_TRUE(lag_returning(lagging(1e-6), kFrame).zero()) << "nearer than a micrometre is back";
}

}  // namespace
}  // namespace mrhi
