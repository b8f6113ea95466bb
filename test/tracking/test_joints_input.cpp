#include "tracking/joints_input.h"

#include <gtest/gtest.h>

#include <random>
#include <string>
#include <vector>

#include "tracker_frames.h"

namespace mrhi {
namespace {

SourceFrame taken(JointsInput& input, const HandJoints& hand, Nanoseconds stamp) {
  return input.take(frame_of(hand, stamp), [](Nanoseconds) { return Pose(); });
}

TEST(Placeholders, AtTheOriginAreMissingJointsAndTheOthersKeepTheirBits) {
  HandJoints hand = hand_away();
  hand.joints[0][4] = hand.joints[2][1] = Vector3::Zero();
  const HandJoints before = hand;
  EXPECT_EQ(drop_placeholders(hand), 2u);
  EXPECT_FALSE(hand.joints[0][4]);
  EXPECT_FALSE(hand.joints[2][1]);
  EXPECT_EQ(hand.joints[1], before.joints[1]);
  EXPECT_EQ(hand.wrist, before.wrist);
}

/// A placeholder that a bridge has moved with its tracker is a point that fingers share.
TEST(Placeholders, ThatWereTransformedAreToldByTwoFingersThatShareAPoint) {
  HandJoints hand = hand_away();
  hand.joints[0][4] = hand.joints[1][4] = hand.joints[4][2] = Vector3(0.1, 0.2, 0.3);
  EXPECT_EQ(drop_placeholders(hand), 3u);
  // Bases that a tracker fills with its wrist, and a bone without length, are of no two fingers.
  HandJoints filled = hand_away();
  for (auto& finger : filled.joints) finger[0] = filled.wrist;
  filled.joints[3][4] = filled.joints[3][3];
  EXPECT_EQ(drop_placeholders(filled), 0u);
}

TEST(Placeholders, OfAllJointsAreNoHandAndAreReportedOnceForEachTimeThatTheyBegin) {
  for (const Vector3& place : {Vector3(Vector3::Zero()), kAway}) {
    JointsInput input;
    HandJoints dead = hand_away();
    dead.wrist = place;
    for (auto& finger : dead.joints) finger.fill(place);
    int reports = 0;
    Nanoseconds stamp = 0;
    for (int time = 0; time < 2; ++time) {
      for (int i = 0; i < 50; ++i) {
        const SourceFrame frame = taken(input, dead, stamp += 10'000'000);
        ASSERT_TRUE(frame.frame) << frame.detail;
        EXPECT_TRUE(frame.frame->hands.empty());
        for (const auto& [kind, what] : frame.corrected) reports += kind == JointsInput::kNoHand;
      }
      EXPECT_EQ(taken(input, hand_away(), stamp += 10'000'000).frame->hands.size(), 1u);
    }
    EXPECT_EQ(reports, 2);
  }
}

/// Some trackers report a hand relative to its wrist, which then never moves.
TEST(Placeholders, AreNotTheWristOfAHandThatIsReportedRelativeToIt) {
  HandJoints hand = hand_away();
  const Vector3 wrist = *hand.wrist;
  hand.wrist = Vector3::Zero();
  for (auto& finger : hand.joints)
    for (auto& joint : finger) *joint -= wrist;
  JointsInput relative;
  EXPECT_TRUE(taken(relative, hand, 1).corrected.empty());
  JointsInput other;
  taken(other, hand_away(), 1);
  const SourceFrame later = taken(other, hand, 2);
  ASSERT_EQ(later.corrected.size(), 1u);
  EXPECT_EQ(later.corrected[0].first, JointsInput::kJointsLeftOut);
}

/// Drivers that send zeros for what they do not know.
TEST(Placeholders, AreAWristAndAPalmAtTheOriginFarFromTheFingers) {
  const SourceFrame whole = [] {
    JointsInput input;
    return input.take({"", {1, {hand_away()}}, {}, {}}, [](Nanoseconds) { return Pose(); });
  }();
  for (const double away : {0.3, 0.6, 1.0}) {
    HandJoints hand = hand_away();
    const Vector3 moved = away * kAway.normalized() - *hand.wrist;
    for (auto& finger : hand.joints)
      for (auto& joint : finger) *joint += moved;
    hand.wrist = hand.palm_centre = Vector3::Zero();
    JointsInput input;
    const SourceFrame frame = input.take({"", {1, {hand}}, {}, {}}, [](Nanoseconds) { return Pose(); });
    ASSERT_TRUE(frame.frame) << frame.detail;
    ASSERT_EQ(frame.frame->hands.size(), 1u);
    EXPECT_LT((frame.frame->hands[0].wrist - whole.frame->hands[0].wrist - moved).norm(), 0.005) << away;
    EXPECT_LT((frame.frame->hands[0].palm.position - whole.frame->hands[0].palm.position - moved).norm(),
              0.005)
        << away;
    ASSERT_EQ(frame.corrected.size(), 1u);
    EXPECT_EQ(frame.corrected[0].second,
              "hand 7: 2 at a placeholder, 0 at the end of a bone that is too long");
  }
}

/// Frames that a network has kept arrive together, each with the time of its arrival.
TEST(Bursts, LeaveOneFrameEach) {
  constexpr Nanoseconds kTick = 8'333'333;
  for (const Nanoseconds between : {20'000, 500'000, 1'000'000}) {
    JointsInput input;
    Nanoseconds stamp = 0;
    for (int i = 0; i < 60; ++i) ASSERT_TRUE(taken(input, hand_away(), stamp += kTick).frame);
    for (int burst = 0; burst < 100; ++burst) {
      stamp += 3 * kTick;
      EXPECT_TRUE(taken(input, hand_away(), stamp).frame);
      for (int late = 1; late < 3; ++late)
        EXPECT_EQ(taken(input, hand_away(), stamp + late * between).reason, JointsInput::kBurst) << burst;
    }
  }
}

// A stream may double its rate, as a camera's does in bright light.
TEST(Bursts, AreNoneInAStreamOfUnevenStampsOrInAFastOne) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uneven(0.7, 1.3);
  JointsInput input, fast;
  Nanoseconds stamp = 0;
  for (const double rate : {60.0, 30.0, 60.0, 120.0}) {
    for (int i = 0; i < 100; ++i) {
      stamp += i == 50 ? 90'000'000 : static_cast<Nanoseconds>(1e9 / rate * uneven(random));
      EXPECT_TRUE(taken(input, hand_away(), stamp).frame) << rate << " " << i;
    }
  }
  for (int i = 1; i < 200; ++i) EXPECT_TRUE(taken(fast, hand_away(), i * 1'000'000).frame) << i;
}

TEST(StrayJoints, AtTheEndOfABoneThatIsTooLongAreDroppedAndTheHandStays) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (std::size_t finger = 0; finger < kFingers; ++finger) {
    for (std::size_t j = 1; j < 5; ++j) {
      HandJoints hand = hand_away();
      *hand.joints[finger][j] += 0.4 * Vector3(number(random), number(random), 1.0).normalized();
      const HandJoints strayed = hand;
      EXPECT_EQ(drop_stray_joints(hand), 1u) << finger << " " << j;
      EXPECT_FALSE(hand.joints[finger][j]) << finger << " " << j;
      EXPECT_EQ(defect(hand), "");
      EXPECT_EQ(hand.wrist, strayed.wrist);
    }
  }
}

TEST(StrayJoints, AreNoneOfAHandInNoise) {
  std::mt19937 random(6);
  std::normal_distribution<double> noise(0.0, 0.005);
  for (int trial = 0; trial < 2000; ++trial) {
    HandJoints hand = hand_away();
    *hand.wrist += Vector3(noise(random), noise(random), noise(random));
    for (auto& finger : hand.joints)
      for (std::size_t j = 1; j < 5; ++j) *finger[j] += Vector3(noise(random), noise(random), noise(random));
    EXPECT_EQ(drop_stray_joints(hand), 0u);
  }
}

TEST(StrayJoints, OfMoreThanAThirdAreNoReasonToKeepTheRest) {
  HandJoints hand = hand_away();
  for (std::size_t f = 0; f < kFingers; ++f)
    for (std::size_t j = 2; j < 5; ++j)
      *hand.joints[f][j] += Vector3(0.5 * static_cast<double>(f), 0.7 * static_cast<double>(j), 0.0);
  EXPECT_EQ(drop_stray_joints(hand), 0u);
  EXPECT_NE(defect(hand), "");
}

/// A thumb's tip at the origin for 0.1 s in 0.5 s, by a grasp at the origin too: no frame is refused, and the
/// tip is where it was.
TEST(JointsInput, JointsAtAPlaceholderForAMomentStayWithTheirHand) {
  for (const Vector3& place : {kAway, Vector3(0.0, 0.0, 0.05)}) {
    JointsInput input;
    for (int i = 0; i < 200; ++i) {
      HandJoints hand = hand_away();
      *hand.wrist += place - kAway;
      for (auto& finger : hand.joints)
        for (auto& joint : finger) *joint += place - kAway;
      const Vector3 tip = *hand.joints[0][4];
      if (i % 50 >= 40) hand.joints[0][4] = Vector3::Zero();
      const SourceFrame frame = taken(input, hand, 1 + i * 10'000'000);
      ASSERT_TRUE(frame.frame) << frame.detail;
      ASSERT_EQ(frame.frame->hands.size(), 1u);
      const Capsule& distal = frame.frame->hands[0].capsules[static_cast<std::size_t>(capsule_index(0, 3))];
      EXPECT_LT((distal.end - tip).norm(), 1e-9) << i;
    }
  }
}

TEST(JointsInput, NamesTheUnitOfAHandAndTheArgumentThatConverts) {
  const std::pair<double, std::string> units[] = {
      {1000.0, "millimetres; allowed: metres; scale:=0.001 (replay: --hand-scale 0.001)"},
      {100.0, "centimetres; allowed: metres; scale:=0.01"},
      {39.37, "inches; allowed: metres; scale:=0.0254"}};
  for (const auto& [factor, words] : units) {
    for (const double size : {0.75, 1.0, 1.3}) {  // of a child and of a large hand
      HandJoints hand = hand_away();
      scale(hand, factor * size);
      JointsInput as_it_is, converting(1.0 / factor);
      const SourceFrame refused = taken(as_it_is, hand, 1);
      EXPECT_FALSE(refused.frame);
      EXPECT_NE(refused.detail.find(words), std::string::npos) << refused.detail;
      const SourceFrame converted = taken(converting, hand, 1);
      ASSERT_TRUE(converted.frame) << converted.detail;
      HandJoints metres = hand_away();
      scale(metres, size);
      EXPECT_LT((converted.frame->hands[0].wrist - *metres.wrist).norm(), 1e-6);  // wrists are float32
    }
  }
}

class Orders : public ::testing::TestWithParam<std::size_t> {
 protected:
  /// The hand's joints as a tracker with this order lists them.
  static std::vector<Vector3> listed(const HandJoints& hand, const JointOrder& order) {
    std::vector<Vector3> points(order.size, *hand.palm_centre);
    points[order.wrist] = *hand.wrist;
    for (std::size_t f = 0; f < kFingers; ++f)
      for (std::size_t j = 0; j < 5; ++j)
        if (order.joints[f][j] != JointOrder::kNotListed) points[order.joints[f][j]] = *hand.joints[f][j];
    return points;
  }
};
INSTANTIATE_TEST_SUITE_P(All, Orders, ::testing::Range<std::size_t>(0, joint_orders().size()));

TEST_P(Orders, ListEachJointOnce) {
  const JointOrder& order = joint_orders()[GetParam()];
  std::vector<int> times(order.size, 0);
  ++times.at(order.wrist);
  for (const auto& finger : order.joints)
    for (const std::size_t place : finger)
      if (place != JointOrder::kNotListed) ++times.at(place);
  for (const int count : times) EXPECT_LE(count, 1) << order.name;
  EXPECT_EQ(&joint_order(order.name), &order);
}

/// In 3 mm of noise on each axis, and with one joint in five missing or at a placeholder.
TEST_P(Orders, AreRecognisedByTheLengthsOfBones) {
  const JointOrder& order = joint_orders()[GetParam()];
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0.0, 0.003);
  std::uniform_real_distribution<double> share(0.0, 1.0);
  for (const Side side : {Side::left, Side::right}) {
    for (const double missing : {double(NAN), 0.0}) {
      OrderRecognition recognition;
      int wrong = 0;
      for (int i = 0; i < 200; ++i) {
        std::vector<Vector3> points = listed(hand_away(side), order);
        for (Vector3& point : points) {
          point += Vector3(noise(random), noise(random), noise(random));
          if (share(random) < 0.2) point.setConstant(missing);
        }
        bool changed = false;
        const JointOrder& found = recognition.order_of(order.size, points.data(), changed);
        if (i >= 10) wrong += &found != &order;
      }
      EXPECT_EQ(wrong, 0) << order.name << " " << missing;
    }
  }
}

/// Trackers write such numbers for what they do not see, at most for a moment.
TEST_P(Orders, StayWhileAJointOfAFingerIsFarAway) {
  const JointOrder& order = joint_orders()[GetParam()];
  for (const double far : {9999.0, 1e30, HUGE_VAL}) {
    for (std::size_t joint = 0; joint < order.size; ++joint) {
      if (joint == order.wrist) continue;
      OrderRecognition recognition;
      for (int frame = 0; frame < 20; ++frame) {
        std::vector<Vector3> points = listed(hand_away(), order);
        if (frame >= 10) points[joint].setConstant(far);
        bool changed = false;
        EXPECT_EQ(&recognition.order_of(order.size, points.data(), changed), &order) << joint;
      }
    }
  }
}

TEST_P(Orders, GiveBackTheHandThatTheyList) {
  const JointOrder& order = joint_orders()[GetParam()];
  const HandJoints hand = hand_away();
  std::vector<float> radii(order.size);
  for (std::size_t i = 0; i < radii.size(); ++i) radii[i] = 0.005f + 0.0001f * static_cast<float>(i);
  const HandJoints found = hand_in_order(order, listed(hand, order).data(), radii.data(), Side::right);
  EXPECT_EQ(found.wrist, hand.wrist);
  for (std::size_t f = 0; f < kFingers; ++f) {
    for (std::size_t j = 1; j < 5; ++j) EXPECT_EQ(found.joints[f][j], hand.joints[f][j]) << order.name;
    const auto& places = order.joints[f];
    EXPECT_EQ(found.bone_width[f][3], radii[places[3]] + radii[places[4]]);
  }
}

TEST(OrderRecognition, RefusesJointsThatAreAHandInNoOrder) {
  std::mt19937 random(8);
  std::vector<Vector3> points(21);
  std::uniform_real_distribution<double> number(-0.1, 0.1);
  int refused = 0;
  for (int trial = 0; trial < 100; ++trial) {
    for (Vector3& point : points) point = Vector3(number(random), number(random), number(random));
    OrderRecognition recognition;
    bool changed = false;
    try {
      recognition.order_of(points.size(), points.data(), changed);
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find("mediapipe, mano"), std::string::npos) << error.what();
      ++refused;
    }
  }
  EXPECT_GT(refused, 80);  // a few random clouds come near to one of five orders
  EXPECT_THROW(joint_order("alphabetical"), std::invalid_argument);
}

TEST(CompleteHand, WidthsOfBonesGoBeforeTheFingers) {
  HandJoints hand = adult_hand(Side::right);
  hand.bone_width[2] = {0.021f, 0.017f, std::nullopt, 0.013f};
  const Hand complete = complete_hand(hand, Pose());
  const double radii[] = {0.0105, 0.0085, 0.009, 0.0065};  // halves; the third is the finger's
  for (int bone = 0; bone < kBonesPerFinger; ++bone)
    EXPECT_NEAR(complete.capsules[static_cast<std::size_t>(capsule_index(2, bone))].radius, radii[bone],
                1e-9);
}

}  // namespace
}  // namespace mrhi
