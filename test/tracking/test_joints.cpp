#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "adult_hand.h"
#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

double degrees_between(const Vector3& a, const Vector3& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / M_PI;
}

class BothSides : public ::testing::TestWithParam<Side> {};
INSTANTIATE_TEST_SUITE_P(Sides, BothSides, ::testing::Values(Side::left, Side::right));

TEST_P(BothSides, PalmPointsToTheFingersAndOutOfTheBack) {
  const Hand hand = complete_hand(adult_hand(GetParam()), Pose());
  // The test's hand is rounded to a millimetre: a degree over its 60 mm.
  EXPECT_LT(degrees_between(hand.palm.orientation * Vector3::UnitX(), Vector3::UnitX()), 1.0);
  EXPECT_LT(degrees_between(hand.palm.orientation * Vector3::UnitZ(), Vector3::UnitZ()), 1.0);
}

TEST_P(BothSides, LeftAndRightAreMirrorImages) {
  HandJoints joints = adult_hand(GetParam());
  joints.wrist.reset();
  for (auto& finger : joints.joints) finger[0].reset();
  const Hand hand = complete_hand(joints, Pose());
  joints = adult_hand(GetParam() == Side::left ? Side::right : Side::left);
  joints.wrist.reset();
  for (auto& finger : joints.joints) finger[0].reset();
  const Hand other = complete_hand(joints, Pose());
  for (std::size_t i = 0; i < kPhalanges; ++i) {
    Vector3 mirrored = other.capsules[i].start;
    mirrored.y() = -mirrored.y();
    EXPECT_LT((hand.capsules[i].start - mirrored).norm(), 1e-12);  // rounding
  }
}

TEST_P(BothSides, PlacementKeepsBoneLengthsAndTurnsThePalmAlong) {
  const HandJoints joints = adult_hand(GetParam());
  const Hand local = complete_hand(joints, Pose());
  std::mt19937 random(3);
  std::uniform_real_distribution<double> number(-1.0, 1.0);
  for (int trial = 0; trial < 100; ++trial) {
    const Pose device{
        Vector3(number(random), number(random), number(random)),
        Quaternion(number(random), number(random), number(random), number(random)).normalized()};
    const Hand placed = complete_hand(joints, device);
    for (std::size_t i = 0; i < kCapsules; ++i) {
      const double before = (local.capsules[i].end - local.capsules[i].start).norm();
      EXPECT_NEAR((placed.capsules[i].end - placed.capsules[i].start).norm(), before, 1e-12);
      EXPECT_EQ(placed.capsules[i].radius, local.capsules[i].radius);
    }
    EXPECT_LT((placed.palm.position - device * local.palm.position).norm(), 1e-12);
    EXPECT_LT(placed.palm.orientation.angularDistance(device.orientation * local.palm.orientation), 1e-7);
  }
}

TEST_P(BothSides, WhatTheTrackerLeftOutIsWhereAnAdultHasIt) {
  const Hand whole = complete_hand(adult_hand(GetParam()), Pose());
  HandJoints joints = adult_hand(GetParam());
  joints.palm_centre.reset();
  joints.palm_width.reset();
  joints.finger_width.fill(std::nullopt);
  for (auto& finger : joints.joints) finger[0].reset();
  const Hand completed = complete_hand(joints, Pose());
  // 5 mm and 10 %: the difference between the test's hand and the average adult's.
  EXPECT_LT((completed.palm.position - whole.palm.position).norm(), 0.005);
  EXPECT_NEAR(completed.palm_width, whole.palm_width, 0.1 * whole.palm_width);
  for (std::size_t i = 0; i < kPhalanges; ++i) {
    EXPECT_EQ(completed.has(static_cast<int>(i)), whole.has(static_cast<int>(i)));
    if (!whole.has(static_cast<int>(i))) continue;
    EXPECT_LT((completed.capsules[i].start - whole.capsules[i].start).norm(), 0.005);
    EXPECT_EQ(completed.capsules[i].end, whole.capsules[i].end);
  }
  const double radii_mm[kFingers] = {9.4, 9.0, 8.8, 8.4, 7.4};
  for (int f = 0; f < kFingers; ++f) {
    const auto distal = static_cast<std::size_t>(capsule_index(f, 3));
    EXPECT_NEAR(1e3 * completed.capsules[distal].radius, radii_mm[f], 0.1 * radii_mm[f]);
  }
}

TEST_P(BothSides, MissingWristIsFoundFromTheRest) {
  HandJoints joints = adult_hand(GetParam());
  joints.wrist.reset();
  EXPECT_LT((complete_hand(joints, Pose()).wrist - adult_hand(GetParam()).wrist.value()).norm(), 0.005);
  for (auto& finger : joints.joints) finger[0].reset();
  // Knuckles and the palm's centre alone say less: 10 mm.
  EXPECT_LT((complete_hand(joints, Pose()).wrist - adult_hand(GetParam()).wrist.value()).norm(), 0.010);
}

TEST_P(BothSides, PalmCapsuleLiesAlongThePalmInsideTheHand) {
  const Hand hand = complete_hand(adult_hand(GetParam()), Pose());
  const Capsule& palm = hand.capsules[kPalm];
  EXPECT_LT((palm.centre() - hand.palm.position).norm(), 1e-12);
  EXPECT_LT(degrees_between(palm.end - palm.start, hand.palm.orientation * Vector3::UnitX()), 1e-6);
  EXPECT_NEAR((palm.end - palm.start).norm(), 0.4 * 0.084, 1e-8);  // float32 palm width
  EXPECT_LT(2.0 * palm.radius, 0.030);                             // an adult's palm is about 30 mm thick
}

TEST(CompleteHand, WidthGivenIsADiameter) {
  const Hand hand = complete_hand(adult_hand(Side::right), Pose());
  EXPECT_EQ(hand.capsules[static_cast<std::size_t>(capsule_index(1, 1))].radius,
            0.5 * static_cast<double>(0.018f));
}

TEST(CompleteHand, ThumbMetacarpalOfZeroLengthIsAbsent) {
  EXPECT_FALSE(complete_hand(adult_hand(Side::right), Pose()).has(capsule_index(0, 0)));
}

TEST(CompleteHand, FewerFingersAndBonesAreTaken) {
  HandJoints joints = adult_hand(Side::right);
  joints.joints[2].fill(std::nullopt);
  joints.joints[4][4].reset();
  ASSERT_EQ(defect(joints), "");
  const Hand hand = complete_hand(joints, Pose());
  EXPECT_TRUE(finite(hand));
  for (int bone = 0; bone < kBonesPerFinger; ++bone) EXPECT_FALSE(hand.has(capsule_index(2, bone)));
  EXPECT_TRUE(hand.has(capsule_index(4, 2)));
  EXPECT_FALSE(hand.has(capsule_index(4, 3)));
}

TEST(CompleteHand, WristIsRoundedToFloat32) {
  HandJoints joints = adult_hand(Side::right);
  const Vector3 wrist = complete_hand(joints, Pose()).wrist;
  EXPECT_EQ(wrist, wrist.cast<float>().cast<double>());
  joints.wrist = joints.wrist.value().cast<float>().cast<double>();
  EXPECT_EQ(complete_hand(joints, Pose()).wrist, wrist);
}

TEST(CompleteHand, StrengthsAreHeldTo0And1) {
  HandJoints joints = adult_hand(Side::right);
  joints.confidence = 1.5f;
  joints.grab_strength = -0.5f;
  const Hand hand = complete_hand(joints, Pose());
  EXPECT_EQ(hand.confidence, 1.0);
  EXPECT_EQ(hand.grab_strength, 0.0);
}

TEST(Defect, NamesWhatIsNotFinite) {
  for (std::size_t f = 0; f < kFingers; ++f)
    for (std::size_t j = 0; j < 5; ++j) {
      HandJoints joints = adult_hand(Side::left);
      joints.joints[f][j] = Vector3(0.0, kNaN, 0.0);
      EXPECT_NE(defect(joints).find("is not finite"), std::string::npos) << f << " " << j;
    }
  HandJoints joints = adult_hand(Side::left);
  joints.joints[1][4] = Vector3(kNaN, 0.0, 0.0);
  EXPECT_EQ(defect(joints), "index tip is not finite");
  joints = adult_hand(Side::left);
  joints.wrist = Vector3(0.0, 0.0, std::numeric_limits<double>::infinity());
  EXPECT_EQ(defect(joints), "wrist is not finite");
  joints = adult_hand(Side::left);
  joints.grab_strength = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(defect(joints), "grab strength is not finite");
}

TEST(Defect, NamesWhatNoHandCanBe) {
  HandJoints joints = adult_hand(Side::right);
  joints.joints[3][4] = joints.joints[3][4].value() + Vector3(0.4, 0.0, 0.0);
  EXPECT_NE(defect(joints).find("ring distal is"), std::string::npos);
  joints = adult_hand(Side::right);
  joints.palm_centre = Vector3(11.0, 0.0, 0.0);
  EXPECT_NE(defect(joints).find("palm centre is"), std::string::npos);
  for (float width : {-0.01f, 0.0f, 0.31f, std::numeric_limits<float>::quiet_NaN()}) {
    joints = adult_hand(Side::right);
    joints.palm_width = width;
    EXPECT_NE(defect(joints).find("palm width"), std::string::npos) << width;
  }
  joints = adult_hand(Side::right);
  joints.joints = {};
  EXPECT_EQ(defect(joints), "it has no finger");
}

TEST(Defect, DegenerateHandsAreRefused) {
  HandJoints joints = adult_hand(Side::right);
  for (auto& finger : joints.joints) finger.fill(Vector3(0.1, 0.2, 0.3));
  joints.palm_centre = joints.wrist = Vector3(0.1, 0.2, 0.3);
  EXPECT_NE(defect(joints), "");
  EXPECT_THROW(complete_hand(joints, Pose()), std::invalid_argument);

  joints = adult_hand(Side::right);
  for (auto& finger : joints.joints)
    for (auto& joint : finger) joint = Vector3(joint.value().x(), 0.0, 0.0);  // all in one line
  joints.wrist = Vector3(-0.065, 0.0, 0.0);
  EXPECT_NE(defect(joints).find("palm cannot be placed"), std::string::npos);
}

TEST(CompleteFrame, DropsTheBadHandAndKeepsTheGood) {
  JointsFrame frame{42, {adult_hand(Side::left), adult_hand(Side::right)}};
  frame.hands[0].id = 3;
  frame.hands[0].palm_centre = Vector3(kNaN, 0.0, 0.0);
  std::vector<std::string> defects;
  const auto completed = complete_frame(frame, Pose(), defects);
  ASSERT_TRUE(completed);
  EXPECT_EQ(completed->stamp, 42);
  ASSERT_EQ(completed->hands.size(), 1u);
  EXPECT_EQ(completed->hands[0].id, 7u);
  ASSERT_EQ(defects.size(), 1u);
  EXPECT_EQ(defects[0], "hand 3: palm centre is not finite");
}

TEST(CompleteFrame, LeavesOutWhatAMessageHasNoRoomFor) {
  JointsFrame frame{42, {adult_hand(Side::left)}};
  std::vector<std::string> defects;
  EXPECT_TRUE(complete_frame(frame, Pose{{0.0, 979.0, 0.0}, Quaternion::Identity()}, defects));
  EXPECT_FALSE(complete_frame(frame, Pose{{0.0, 981.0, 0.0}, Quaternion::Identity()}, defects));
  EXPECT_NE(defects.at(0).find("palm is farther than 980 m"), std::string::npos) << defects[0];
  frame.hands[0].bone_width[1][2] = 0.19f;
  EXPECT_TRUE(complete_frame(frame, Pose(), defects));
  frame.hands[0].bone_width[1][2] = 0.2f;
  EXPECT_FALSE(complete_frame(frame, Pose(), defects));
  EXPECT_NE(defects.at(1).find("index intermediate width"), std::string::npos) << defects[1];
}

TEST(CompleteFrame, IsNothingIfNoHandIsUsable) {
  JointsFrame frame{42, {adult_hand(Side::left)}};
  frame.hands[0].palm_centre = Vector3(kNaN, 0.0, 0.0);
  std::vector<std::string> defects;
  EXPECT_FALSE(complete_frame(frame, Pose(), defects));
  EXPECT_TRUE(complete_frame(JointsFrame{42, {}}, Pose(), defects)) << "a frame with no hand is good";
  frame.hands = {adult_hand(Side::left), adult_hand(Side::right)};
  ASSERT_TRUE(complete_frame(frame, Pose(), defects));
  EXPECT_EQ(defects.back(), "hand 7: its id is that of another hand in the frame");
}

}  // namespace
}  // namespace mrhi
