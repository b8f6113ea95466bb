#include "mr_hand_interaction/ros/leap_human.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "leap_messages.h"
#include "sample_hands.h"

namespace mrhi {
namespace {

LeapHumanDecoder::Frame decode(LeapVersion version, const JointsFrame& frame) {
  const auto bytes = LeapWriter(version).human(frame);
  return LeapHumanDecoder(leap_definition(version)).decode(bytes.data(), bytes.size());
}

TEST(LeapHuman, EveryVersionGivesTheSameBits) {
  const Pose device{Vector3(0.1, 0.2, 0.3), Quaternion(0.7, 0.7, 0.1, -0.1).normalized()};
  for (const JointsFrame& sent : sample_frames()) {
    std::vector<std::string> defects;
    const auto direct = complete_frame(sent, device, defects);
    for (LeapVersion version : kLeapVersions) {
      const auto received = decode(version, sent);
      EXPECT_EQ(received.frame_id, "leap_hands");
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
  for (LeapVersion version : kLeapVersions) {
    const HandJoints hand = decode(version, sent).joints.hands.at(0);
    EXPECT_FALSE(hand.wrist || hand.palm_centre || hand.palm_width || hand.finger_width[2]);
    EXPECT_FALSE(hand.joints[1][0]);
    EXPECT_EQ(hand.joints[1][1], sent.hands[0].joints[1][1]);
  }
}

TEST(LeapHuman, MessagesCutAnywhereAreMalformed) {
  for (LeapVersion version : kLeapVersions) {
    const LeapHumanDecoder decoder(leap_definition(version));
    const auto bytes = LeapWriter(version).human(sample_frames().front());
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      // A copy of just that size, so that a memory checker sees any byte read beyond it.
      const std::unique_ptr<std::uint8_t[]> cut(new std::uint8_t[size]);
      std::copy(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size), cut.get());
      try {
        decoder.decode(cut.get(), size);
        FAIL() << "taken with " << size << " of " << bytes.size() << " bytes";
      } catch (const DecodeError& error) {
        ASSERT_EQ(error.kind(), DecodeError::Kind::malformed);
        ASSERT_NE(
            std::string(error.what()).find("message ends inside leap_motion/Human.") == std::string::npos &&
                std::string(error.what()).find("_") == std::string::npos,
            true);
      }
    }
    auto longer = bytes;
    longer.push_back(0);
    EXPECT_THROW(decoder.decode(longer.data(), longer.size()), DecodeError);
  }
}

TEST(LeapHuman, AnyFourBytesMayBeAnAbsurdLength) {
  const LeapHumanDecoder decoder(leap_definition(LeapVersion::head));
  const auto bytes = LeapWriter(LeapVersion::head).human(sample_frames().front());
  for (std::size_t at = 0; at + 4 <= bytes.size(); ++at) {
    auto broken = bytes;
    std::fill_n(broken.begin() + static_cast<std::ptrdiff_t>(at), 4, std::uint8_t{0xff});
    try {
      decoder.decode(broken.data(), broken.size());
    } catch (const DecodeError&) {
    }
  }
}

std::string count_error(const std::vector<std::uint8_t>& fingers, const std::vector<std::uint8_t>& bones,
                        bool drop_one) {
  LeapWriter writer(LeapVersion::head);
  writer.extra_finger = fingers;
  writer.extra_bone = bones;
  JointsFrame frame{1, {sample_hand(Side::right)}};
  if (drop_one) frame.hands[0].joints[1][4].reset();
  const auto bytes = writer.human(frame);
  try {
    LeapHumanDecoder(leap_definition(LeapVersion::head)).decode(bytes.data(), bytes.size());
  } catch (const DecodeError& error) {
    EXPECT_STREQ(error.reason(), "wrong finger or bone count");
    return error.what();
  }
  return "taken";
}

TEST(LeapHuman, WrongCountsAreRefused) {
  EXPECT_EQ(count_error({}, {}, false), "taken");
  EXPECT_EQ(count_error({}, {}, true), "taken");
  EXPECT_EQ(count_error({5}, {}, false), "leap_motion/Hand.finger_list has 6 entries; at most 5");
  EXPECT_EQ(count_error({}, {3}, false), "leap_motion/Finger.bone_list has 5 entries; at most 4");
  EXPECT_EQ(count_error({}, {1}, true), "leap_motion/Finger.bone_list has type 1 twice");
  EXPECT_EQ(count_error({}, {4}, true), "leap_motion/Finger.bone_list has type 4; 0 to 3 are known");
}

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  for (std::size_t at = 0; (at = text.find(from, at)) != std::string::npos; at += to.size())
    text.replace(at, from.size(), to);
  return text;
}

std::string definition_error(const std::string& definition) {
  try {
    LeapHumanDecoder decoder(definition);
  } catch (const DecodeError& error) {
    EXPECT_EQ(error.kind(), DecodeError::Kind::unknown_version);
    return error.what();
  }
  return "taken";
}

TEST(LeapHuman, UnknownVersionsAreRefusedByTheFieldThatDiffers) {
  const std::string head = leap_definition(LeapVersion::head);
  const std::string unknown = "unknown version of leap_motion/Human: ";
  EXPECT_EQ(definition_error(head), "taken");
  EXPECT_EQ(definition_error(replaced(head, "palm_center", "palm_centre")),
            unknown + "no field leap_motion/Hand.palm_center");
  EXPECT_EQ(definition_error(replaced(head, "float32 palm_width", "float64 palm_width")),
            unknown + "field leap_motion/Hand.palm_width is float64; float32 is needed");
  EXPECT_EQ(definition_error(replaced(head, "Bone[] bone_list", "Bone[4] bone_list")),
            unknown + "field leap_motion/Finger.bone_list is leap_motion/Bone[N]; message[] is needed");
  EXPECT_EQ(definition_error("string data"), unknown + "no field leap_motion/Human.header");
  EXPECT_EQ(definition_error(""), unknown + "no field leap_motion/Human.header");
  EXPECT_NE(definition_error(replaced(head, "MSG: leap_motion/Bone", "MSG: leap_motion/Bond")), "taken");
  EXPECT_NE(definition_error(replaced(head, "int32 lmc_frame_id", "Hand[x] lmc_frame_id")), "taken");
  EXPECT_NE(definition_error(replaced(head, "uint32 seq", "Header seq")), "taken")
      << "a type that contains itself";
}

TEST(LeapHuman, DefinitionsThatAreNestedWithoutEndOrLieAboutSizesAreRefused) {
  const auto nested = [](int levels, const std::string& count) {
    std::string text = "T0" + count + " t\n";
    for (int i = 0; i < levels; ++i)
      text += std::string(80, '=') + "\nMSG: leap_motion/T" + std::to_string(i) + "\n" +
              (i + 1 < levels ? "T" + std::to_string(i + 1) + count + " t\n" : "uint8 t\n");
    return text;
  };
  EXPECT_NE(definition_error(nested(100'000, "")).find("at most 262144"), std::string::npos);
  EXPECT_EQ(definition_error(nested(2200, "")),
            "unknown version of leap_motion/Human: no field leap_motion/Human.header");
  EXPECT_EQ(definition_error(nested(9, "[999999999]")),
            "unknown version of leap_motion/Human: no field leap_motion/Human.header");
}

TEST(LeapHuman, LaterVersionsThatKeepTheNamesAreRead) {
  const JointsFrame sent{5, {sample_hand(Side::right)}};
  const std::string definition =
      replaced(leap_definition(LeapVersion::august_2019), "int32 nr_of_gestures", "uint32 nr_of_gestures");
  const auto bytes = LeapWriter(LeapVersion::august_2019).human(sent);
  EXPECT_EQ(LeapHumanDecoder(definition).decode(bytes.data(), bytes.size()).joints.hands.at(0).id,
            sent.hands[0].id);
}

TEST(LeapHuman, NumbersThatAreNotFiniteArriveAsSuch) {
  JointsFrame sent{5, {sample_hand(Side::right)}};
  sent.hands[0].joints[2][3] = Vector3(0.0, std::numeric_limits<double>::quiet_NaN(), 0.0);
  EXPECT_EQ(defect(decode(LeapVersion::head, sent).joints.hands.at(0)),
            "middle intermediate end is not finite");

  // Where two bones meet, the joint is in the message twice.
  auto bytes = LeapWriter(LeapVersion::head).human({5, {sample_hand(Side::right)}});
  const double tip_of_proximal = sample_hand(Side::right).joints[2][2].value().x();
  const auto* pattern = reinterpret_cast<const std::uint8_t*>(&tip_of_proximal);
  const auto at = std::search(bytes.begin(), bytes.end(), pattern, pattern + sizeof tip_of_proximal);
  ASSERT_NE(at, bytes.end());
  std::fill_n(at, sizeof tip_of_proximal, std::uint8_t{0xff});  // a NaN
  const auto hand = LeapHumanDecoder(leap_definition(LeapVersion::head)).decode(bytes.data(), bytes.size());
  EXPECT_NE(defect(hand.joints.hands.at(0)).find("is not finite"), std::string::npos);
}

}  // namespace
}  // namespace mrhi
