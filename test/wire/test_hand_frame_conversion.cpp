#include "mr_hand_interaction/ros/hand_frame_conversion.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "mr_hand_interaction/ros/leap_human.h"
#include "mr_hand_interaction/ros/pose_array_hand.h"
#include "sample_hands.h"

namespace mrhi {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

HandFrame sample_frame() {
  std::vector<std::string> defects;
  const Pose device{Vector3(0.1, 0.2, 0.3), Quaternion(0.7, 0.7, 0.1, -0.1).normalized()};
  return complete_frame(sample_frames().front(), device, defects).value();
}

TEST(HandFrameConversion, ThereAndBackGivesTheSameBits) {
  const HandFrame sent = sample_frame();
  const auto message = to_message(sent, "world");
  EXPECT_EQ(message.header.frame_id, "world");
  const HandFrame back = from_message(message);
  EXPECT_EQ(back.stamp, sent.stamp);
  ASSERT_EQ(back.hands.size(), sent.hands.size());
  for (std::size_t h = 0; h < sent.hands.size(); ++h) expect_same_bits(sent.hands[h], back.hands[h]);
}

TEST(HandFrameConversion, AbsentPhalangesAndThePalmAreLeftOut) {
  const auto message = to_message(sample_frame(), "world");
  EXPECT_EQ(message.hands[0].phalanges.size(), 19u);
  EXPECT_EQ(message.hands[0].phalanges[0].bone, mr_hand_interaction::Phalanx::PROXIMAL);
}

TEST(HandFrameConversion, TouchingGoesWithItsPhalanx) {
  Touching touching{};
  touching[static_cast<std::size_t>(capsule_index(2, 3))] = true;
  for (const auto& phalanx : to_message(sample_frame().hands[0], touching).phalanges)
    EXPECT_EQ(phalanx.touching != 0, phalanx.finger == 2 && phalanx.bone == 3);
}

TEST(HandFrameConversion, BadMessagesAreRefusedByName) {
  using Message = mr_hand_interaction::Hand;
  const std::vector<std::pair<std::string, std::function<void(Message&)>>> faults{
      {"side is neither LEFT nor RIGHT", [](Message& m) { m.side = 2; }},
      {"confidence nan is not in 0 to", [](Message& m) { m.confidence = kNaN; }},
      {"palm is not finite", [](Message& m) { m.palm.position.x = static_cast<double>(kNaN); }},
      {"palm orientation is no unit quaternion", [](Message& m) { m.palm.orientation = {}; }},
      {"palm_width 0.400000 is not in 0 to 0.300000", [](Message& m) { m.palm_width = 0.4f; }},
      {"radius -0.010000 is not in 0 to 0.100000", [](Message& m) { m.phalanges[3].radius = -0.01f; }},
      {"finger 5 bone 0 is not known",
       [](Message& m) { m.phalanges[0].finger = 5, m.phalanges[0].bone = 0; }},
      {"finger 0 bone 1 is given twice", [](Message& m) { m.phalanges.push_back(m.phalanges[0]); }},
      {"end of a phalanx is not finite",
       [](Message& m) { m.phalanges[2].end.z = static_cast<double>(kNaN); }},
  };
  for (const auto& [text, spoil] : faults) {
    auto message = to_message(sample_frame(), "world");
    spoil(message.hands[1]);
    try {
      from_message(message);
      ADD_FAILURE() << "taken: " << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()).find("hand 32: " + text), 0u) << error.what();
    }
  }
}

geometry_msgs::PoseArray mediapipe_hand(const HandJoints& hand) {
  geometry_msgs::PoseArray message;
  message.header.stamp = ros::Time(3, 5);
  message.poses.resize(1);
  message.poses[0].position = to_message(hand.wrist.value());
  for (const auto& finger : hand.joints)
    for (std::size_t j = 1; j < finger.size(); ++j) {
      message.poses.emplace_back();
      message.poses.back().position = to_message(finger[j].value());
    }
  return message;
}

TEST(PoseArrayHand, TwentyOneJointsAreTheHandWithoutMetacarpalBases) {
  const HandJoints sent = sample_hand(Side::left);
  const JointsFrame frame = joints_from_pose_array(mediapipe_hand(sent), Side::left);
  EXPECT_EQ(frame.stamp, 3000000005);
  ASSERT_EQ(frame.hands.size(), 1u);
  const HandJoints& hand = frame.hands[0];
  EXPECT_EQ(hand.side, Side::left);
  EXPECT_EQ(hand.wrist, sent.wrist);
  for (std::size_t f = 0; f < kFingers; ++f) {
    EXPECT_FALSE(hand.joints[f][0]);
    for (std::size_t j = 1; j < 5; ++j) EXPECT_EQ(hand.joints[f][j], sent.joints[f][j]);
  }
  ASSERT_EQ(defect(hand), "");
  const Hand completed = complete_hand(hand, Pose());
  // The palm's centre and direction come from wrist and knuckles alone: 1 cm, 10 degrees.
  EXPECT_LT((completed.palm.position - sent.palm_centre.value()).norm(), 0.010);
  const Hand whole = complete_hand(sent, Pose());
  EXPECT_LT(completed.palm.orientation.angularDistance(whole.palm.orientation), 0.175);
}

TEST(PoseArrayHand, NoPosesIsAFrameWithNoHandAndOtherCountsAreRefused) {
  geometry_msgs::PoseArray message;
  EXPECT_TRUE(joints_from_pose_array(message, Side::right).hands.empty());
  for (std::size_t count : {1u, 20u, 22u, 26u}) {
    message.poses.resize(count);
    EXPECT_THROW(joints_from_pose_array(message, Side::right), DecodeError);
  }
}

}  // namespace
}  // namespace mrhi
