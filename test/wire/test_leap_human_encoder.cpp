#include <gtest/gtest.h>

#include <stdexcept>

#include "mr_hand_interaction/ros/leap_human.h"
#include "mr_hand_interaction/synthetic/hand_skeleton.h"
#include "ros/leap_human_encoder.h"

namespace mrhi {
namespace {

constexpr Nanoseconds kStamp = 1600000000123456789;

HandJoints some_hand(Side side) {
  const Pose wrist{{0.05, 0.2, 0.1}, Quaternion(0.9, 0.1, 0.4, -0.1).normalized()};
  HandJoints hand = hand_joints(human_hand(), side, wrist, relaxed_posture());
  hand.id = side == Side::left ? 7 : 8;
  hand.confidence = 0.75f;
  return hand;
}

LeapHumanDecoder::Frame through_the_wire(const JointsFrame& frame) {
  const auto bytes = LeapHumanEncoder::encode(frame, "leap_hands", 42, 115.0f);
  return LeapHumanDecoder(LeapHumanEncoder::definition()).decode(bytes.data(), bytes.size());
}

/// float64 and float32 fields go through the wire without loss: compared exactly.
void expect_same(const HandJoints& sent, const HandJoints& got) {
  EXPECT_EQ(sent.id, got.id);
  EXPECT_EQ(sent.side, got.side);
  EXPECT_EQ(sent.confidence, got.confidence);
  EXPECT_EQ(sent.grab_strength, got.grab_strength);
  EXPECT_EQ(sent.pinch_strength, got.pinch_strength);
  EXPECT_EQ(sent.palm_centre, got.palm_centre);
  EXPECT_EQ(sent.palm_width, got.palm_width);
  EXPECT_EQ(sent.wrist, got.wrist);
  EXPECT_EQ(sent.joints, got.joints);
  EXPECT_EQ(sent.finger_width, got.finger_width);
}

TEST(LeapHumanEncoder, two_hands_come_back_as_they_were) {
  const JointsFrame sent{kStamp, {some_hand(Side::right), some_hand(Side::left)}};
  const auto got = through_the_wire(sent);
  EXPECT_EQ(got.frame_id, "leap_hands");
  EXPECT_EQ(got.joints.stamp, kStamp);
  ASSERT_EQ(got.joints.hands.size(), 2u);
  expect_same(sent.hands[0], got.joints.hands[0]);
  expect_same(sent.hands[1], got.joints.hands[1]);
}

TEST(LeapHumanEncoder, a_frame_without_hands_has_none) {
  const auto got = through_the_wire({kStamp, {}});
  EXPECT_EQ(got.joints.stamp, kStamp);
  EXPECT_TRUE(got.joints.hands.empty());
}

TEST(LeapHumanEncoder, what_a_hand_lacks_stays_unknown) {
  HandJoints hand = some_hand(Side::left);
  hand.wrist.reset();
  hand.palm_width.reset();
  hand.joints[3].fill(std::nullopt);
  hand.finger_width[3].reset();
  hand.joints[2][0].reset();
  const auto got = through_the_wire({kStamp, {hand}});
  ASSERT_EQ(got.joints.hands.size(), 1u);
  expect_same(hand, got.joints.hands[0]);
}

TEST(LeapHumanEncoder, refuses_two_hands_of_one_side) {
  const JointsFrame frame{kStamp, {some_hand(Side::right), some_hand(Side::right)}};
  EXPECT_THROW(LeapHumanEncoder::encode(frame, "leap_hands", 0, 115.0f), std::invalid_argument);
}

}  // namespace
}  // namespace mrhi
