#include "mr_hand_interaction/ros/leap_human.h"

#include <gtest/gtest.h>
#include <mr_hand_interaction/LeapAugust2019Human.h>
#include <mr_hand_interaction/LeapFebruary2020Human.h>
#include <mr_hand_interaction/LeapHuman.h>
#include <mr_hand_interaction/LeapMelodicHuman.h>

#include <algorithm>
#include <limits>

#include "ros/leap_human_publisher.h"
#include "sample_hands.h"

namespace mrhi {
namespace {

namespace msg = mr_hand_interaction;
using Bytes = std::vector<std::uint8_t>;

template <class Human>
Bytes serialised(const Human& human) {
  Bytes bytes(ros::serialization::serializationLength(human));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, human);
  return bytes;
}

msg::LeapHuman human_of(const JointsFrame& frame) {
  topic_tools::ShapeShifter message;
  write_leap(frame, "leap_hands", 42, 115.0f, message);
  Bytes bytes(message.size());
  ros::serialization::OStream out(bytes.data(), message.size());
  message.write(out);
  msg::LeapHuman human;
  ros::serialization::IStream in(bytes.data(), message.size());
  ros::serialization::deserialize(in, human);
  return human;
}

template <class Hand>
void add_axes(const msg::LeapHand& newest, Hand& hand) {
  hand.direction = newest.direction;
  hand.normal = newest.normal;
}
void add_axes(const msg::LeapHand& /*newest*/, msg::LeapMelodicHand& /*hand*/) {}

template <class Hand>
Hand older(const msg::LeapHand& newest) {
  Hand hand;
  hand.header = newest.header;
  hand.lmc_hand_id = newest.lmc_hand_id;
  hand.is_present = newest.is_present;
  hand.confidence = newest.confidence;
  hand.grab_strength = newest.grab_strength;
  hand.pinch_strength = newest.pinch_strength;
  hand.palm_velocity = {0.1f, 0.2f, 0.3f};
  hand.palm_center = newest.palm_center;
  hand.palm_width = newest.palm_width;
  const auto& wrist = newest.arm.wrist.position;
  if (wrist.x != 0.0)
    hand.wrist_position = {static_cast<float>(wrist.x), static_cast<float>(wrist.y),
                           static_cast<float>(wrist.z)};
  hand.to_string = "a hand";
  hand.finger_list = newest.finger_list;
  hand.gesture_list.resize(1);
  hand.gesture_list[0].pointable_ids = {8, 9};
  add_axes(newest, hand);
  return hand;
}

struct Message {
  std::string md5;
  Bytes bytes;
};

template <class Human>
Message older(const msg::LeapHuman& newest) {
  Human human;
  human.header = newest.header;
  human.to_string = "a frame";
  human.right_hand = older<decltype(human.right_hand)>(newest.right_hand);
  human.left_hand = older<decltype(human.left_hand)>(newest.left_hand);
  return {ros::message_traits::md5sum<Human>(), serialised(human)};
}

Message newest(const msg::LeapHuman& human) {
  return {ros::message_traits::md5sum<msg::LeapHuman>(), serialised(human)};
}

std::vector<Message> in_every_version(const JointsFrame& frame) {
  const msg::LeapHuman human = human_of(frame);
  return {newest(human), older<msg::LeapFebruary2020Human>(human), older<msg::LeapAugust2019Human>(human),
          older<msg::LeapMelodicHuman>(human)};
}

LeapFrame read(const Message& message) {
  return read_leap(message.md5, message.bytes);
}

/// "taken", or why not.
std::string answer(const Message& message, DecodeError::Kind kind) {
  try {
    read(message);
  } catch (const DecodeError& error) {
    EXPECT_EQ(error.kind(), kind);
    return error.what();
  }
  return "taken";
}

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

TEST(LeapHuman, TheMessagesHaveTheMd5sThatTheDriverPublished) {
  const auto messages = in_every_version({});
  EXPECT_EQ(messages[0].md5, "2817a017ab58b244566892058c4f6e6d");
  EXPECT_EQ(messages[1].md5, "3bd6af829f83963a7331d3ab3569550a");
  EXPECT_EQ(messages[2].md5, "ca08153c68f1f03536845a545510cf3e");
  EXPECT_EQ(messages[3].md5, "3e3d8dfe1324daa216cc0e23d891da6e");
}

TEST(LeapHuman, WhatIsWrittenIsOfTheDriversTypeAndNamesNoneOfOurs) {
  topic_tools::ShapeShifter message;
  write_leap({}, "leap_hands", 0, 115.0f, message);
  EXPECT_EQ(message.getDataType(), "leap_motion/Human");
  EXPECT_EQ(message.getMD5Sum(), "2817a017ab58b244566892058c4f6e6d");
  const std::string& definition = message.getMessageDefinition();
  EXPECT_EQ(definition.find("mr_hand_interaction"), std::string::npos);
  for (const char* part : {"Hand", "Finger", "Bone", "Gesture", "Arm"})
    EXPECT_NE(definition.find(std::string("\nMSG: leap_motion/") + part + "\n"), std::string::npos) << part;
}

TEST(LeapHuman, TwoHandsComeBackAsTheyWere) {
  const JointsFrame sent{1600000000123456789, {sample_hand(Side::right), sample_hand(Side::left)}};
  const LeapFrame got = read(newest(human_of(sent)));
  EXPECT_EQ(got.frame_id, "leap_hands");
  EXPECT_EQ(got.sequence, 42u);
  EXPECT_EQ(got.joints.stamp, sent.stamp);
  ASSERT_EQ(got.joints.hands.size(), 2u);
  expect_same(sent.hands[0], got.joints.hands[0]);
  expect_same(sent.hands[1], got.joints.hands[1]);
}

TEST(LeapHuman, TwoHandsOfOneSideAreNotWritten) {
  EXPECT_THROW(human_of({1, {sample_hand(Side::right), sample_hand(Side::right)}}), std::invalid_argument);
}

TEST(LeapHuman, EveryVersionGivesTheSameBits) {
  const Pose device{Vector3(0.1, 0.2, 0.3), Quaternion(0.7, 0.7, 0.1, -0.1).normalized()};
  for (const JointsFrame& sent : sample_frames()) {
    std::vector<std::string> defects;
    const auto direct = complete_frame(sent, device, defects);
    for (const Message& message : in_every_version(sent)) {
      const LeapFrame received = read(message);
      EXPECT_EQ(received.joints.stamp, sent.stamp);
      const auto frame = complete_frame(received.joints, device, defects);
      ASSERT_TRUE(direct && frame && defects.empty());
      ASSERT_EQ(frame->hands.size(), direct->hands.size());
      for (std::size_t i = 0; i < frame->hands.size(); ++i)
        expect_same_bits(frame->hands[i], direct->hands[i]);
    }
  }
}

TEST(LeapHuman, FieldsThatTheDriverDoesNotKnowAreAbsent) {
  JointsFrame sent{1, {sample_hand(Side::left)}};
  sent.hands[0].wrist.reset();
  sent.hands[0].palm_centre.reset();
  sent.hands[0].palm_width.reset();
  sent.hands[0].finger_width.fill(std::nullopt);
  sent.hands[0].joints[1][0].reset();
  sent.hands[0].joints[3].fill(std::nullopt);
  for (const Message& message : in_every_version(sent))
    expect_same(sent.hands[0], read(message).joints.hands.at(0));
}

TEST(LeapHuman, MessagesCutAnywhereAreMalformed) {
  for (const Message& whole : in_every_version(sample_frames().front())) {
    for (std::size_t size = 0; size < whole.bytes.size(); ++size) {
      const Bytes cut(whole.bytes.begin(), whole.bytes.begin() + static_cast<std::ptrdiff_t>(size));
      ASSERT_EQ(answer({whole.md5, cut}, DecodeError::Kind::malformed),
                "leap_motion/Human of " + std::to_string(size) + " bytes ends before all of its fields");
    }
    Message longer = whole;
    longer.bytes.push_back(0);
    EXPECT_NE(answer(longer, DecodeError::Kind::malformed).find("bytes has 1 after all of its fields"),
              std::string::npos);
  }
}

TEST(LeapHuman, AListThatClaimsAllMemoryIsRefused) {
  msg::LeapHuman human = human_of({});
  human.right_hand.palm_velocity = {7.25f};
  Message message = newest(human);
  const Bytes list = serialised(human.right_hand.palm_velocity);
  const auto at = std::search(message.bytes.begin(), message.bytes.end(), list.begin(), list.end());
  ASSERT_NE(at, message.bytes.end());
  std::fill_n(at, 4, std::uint8_t{0xff});
  EXPECT_NE(answer(message, DecodeError::Kind::malformed).find("a list or text of more than 65536 bytes"),
            std::string::npos);
}

TEST(LeapHuman, AnyFourBytesMayBeAnAbsurdLength) {
  const Message whole = newest(human_of(sample_frames().front()));
  for (std::size_t at = 0; at + 4 <= whole.bytes.size(); ++at) {
    Message broken = whole;
    std::fill_n(broken.bytes.begin() + static_cast<std::ptrdiff_t>(at), 4, std::uint8_t{0xff});
    try {
      read(broken);
    } catch (const DecodeError&) {
    }
  }
}

TEST(LeapHuman, WrongCountsAreRefused) {
  const msg::LeapHuman whole = human_of({1, {sample_hand(Side::right)}});
  const auto after = [&](auto change) {
    msg::LeapHuman human = whole;
    change(human.right_hand.finger_list);
    return answer(newest(human), DecodeError::Kind::wrong_count);
  };
  using Fingers = decltype(whole.right_hand.finger_list);
  EXPECT_EQ(after([](Fingers& fingers) { fingers.pop_back(); }), "taken");
  EXPECT_EQ(after([](Fingers& fingers) { fingers[1].bone_list.pop_back(); }), "taken");
  EXPECT_EQ(after([](Fingers& fingers) { fingers.push_back(fingers[0]); }),
            "leap_motion/Hand.finger_list has 6 entries; at most 5");
  EXPECT_EQ(after([](Fingers& fingers) { fingers[1].bone_list.push_back(fingers[1].bone_list[0]); }),
            "leap_motion/Finger.bone_list has 5 entries; at most 4");
  EXPECT_EQ(after([](Fingers& fingers) { fingers[1].bone_list[3].type = 1; }),
            "leap_motion/Finger.bone_list has type 1 twice");
  EXPECT_EQ(after([](Fingers& fingers) { fingers[1].bone_list[3].type = 4; }),
            "leap_motion/Finger.bone_list has type 4; 0 to 3 are known");
}

TEST(LeapHuman, UnknownVersionsAreRefusedByTheirMd5) {
  EXPECT_EQ(answer({"992ce8a1687cec8c8bd883ec73ca41d1", {}}, DecodeError::Kind::unknown_version),
            "unknown version of leap_motion/Human: md5 992ce8a1687cec8c8bd883ec73ca41d1; allowed: "
            "2817a017ab58b244566892058c4f6e6d, 3bd6af829f83963a7331d3ab3569550a, "
            "3e3d8dfe1324daa216cc0e23d891da6e, ca08153c68f1f03536845a545510cf3e");
}

TEST(LeapHuman, NumbersThatAreNotFiniteArriveAsSuch) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  JointsFrame sent{5, {sample_hand(Side::right)}};
  sent.hands[0].joints[2][3] = Vector3(0.0, kNan, 0.0);
  EXPECT_EQ(defect(read(newest(human_of(sent))).joints.hands.at(0)), "middle intermediate end is not finite");

  // Where two bones meet, the joint is in the message twice.
  msg::LeapHuman human = human_of({5, {sample_hand(Side::right)}});
  human.right_hand.finger_list[2].bone_list[1].bone_end.position.x = kNan;
  EXPECT_NE(defect(read(newest(human)).joints.hands.at(0)).find("is not finite"), std::string::npos);
}

}  // namespace
}  // namespace mrhi
