#include "replay/inputs.h"

#include <geometry_msgs/PoseArray.h>
#include <gtest/gtest.h>
#include <mr_hand_interaction/HandFrame.h>
#include <rosbag/bag.h>
#include <std_msgs/Header.h>
#include <tf2_msgs/TFMessage.h>
#include <topic_tools/shape_shifter.h>

#include <fstream>
#include <iterator>

#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "mr_hand_interaction/ros/leap_human.h"
#include "replay/replay_files.h"
#include "ros/leap_human_publisher.h"

namespace mrhi {
namespace {

constexpr double kRate = 60.0;
constexpr Nanoseconds kBegin = 1'000'000'000'000;

const std::vector<JointsFrame>& frames() {
  static const auto all = test::motion_frames("nudge", kRate, kBegin);
  return all;
}

/// A bag in the making.
struct TestBag {
  explicit TestBag(const std::string& name) : file(folder / name), bag(file, rosbag::bagmode::Write) {}

  template <class Message>
  void add(const std::string& topic, Nanoseconds time, const Message& message) {
    bag.write(topic, to_ros_time(time), message);
  }

  void add_leap(const std::string& topic, const JointsFrame& frame, std::size_t cut = 0,
                const std::string& frame_id = "leap_hands") {
    topic_tools::ShapeShifter message;
    write_leap(frame, frame_id, 0, static_cast<float>(kRate), message);
    std::vector<std::uint8_t> bytes(message.size());
    ros::serialization::OStream out(bytes.data(), message.size());
    message.write(out);
    ros::serialization::IStream in(bytes.data(), static_cast<std::uint32_t>(bytes.size() - cut));
    message.read(in);
    add(topic, frame.stamp, message);
  }

  void add_static(const std::string& parent, const std::string& child, const Vector3& place) {
    add_transform("/tf_static", kBegin, 0, parent, child, place);
  }
  void add_transform(const std::string& topic, Nanoseconds time, Nanoseconds stamp, const std::string& parent,
                     const std::string& child, const Vector3& place) {
    tf2_msgs::TFMessage message;
    message.transforms.resize(1);
    message.transforms[0].header.stamp = to_ros_time(stamp);
    message.transforms[0].header.frame_id = parent;
    message.transforms[0].child_frame_id = child;
    message.transforms[0].transform.translation.x = place.x();
    message.transforms[0].transform.translation.y = place.y();
    message.transforms[0].transform.translation.z = place.z();
    message.transforms[0].transform.rotation.w = 1.0;
    add(topic, time, message);
  }

  std::vector<SourceFrame> read(const std::optional<std::string>& topic = {},
                                const std::optional<Pose>& device = {}) {
    bag.close();
    const ReplayInput opened = open_bag(file, topic, device);
    FrameSource& input = *opened.frames;
    EXPECT_EQ(input.position(), 0u);
    std::vector<SourceFrame> all;
    while (auto frame = input.next()) all.push_back(*frame);
    EXPECT_EQ(input.position(), input.size());
    EXPECT_EQ(input.size(), all.size());
    return all;
  }

  test::Folder folder;
  std::string file;
  rosbag::Bag bag;
};

std::string refusal(TestBag& bag, const std::optional<std::string>& topic = {}) {
  try {
    bag.read(topic);
  } catch (const BagError& error) {
    return error.what();
  }
  return "";
}

void expect_same(const Hand& a, const Hand& b) {
  EXPECT_EQ(a.id, b.id);
  EXPECT_EQ(a.palm.position, b.palm.position);
  for (std::size_t i = 0; i < a.capsules.size(); ++i) {
    EXPECT_EQ(a.capsules[i].start, b.capsules[i].start) << i;
    EXPECT_EQ(a.capsules[i].end, b.capsules[i].end) << i;
    EXPECT_EQ(a.capsules[i].radius, b.capsules[i].radius) << i;
  }
}

TEST(BagInput, leap_frames_come_as_they_were_recorded) {
  TestBag bag("leap.bag");
  for (const JointsFrame& frame : frames()) bag.add_leap("/leap_motion/leap_device", frame);
  const auto read = bag.read();
  ASSERT_EQ(read.size(), frames().size());
  for (std::size_t i = 0; i < read.size(); ++i) {
    ASSERT_TRUE(read[i].frame) << read[i].detail;
    EXPECT_EQ(read[i].frame->stamp, frames()[i].stamp);
    ASSERT_EQ(read[i].frame->hands.size(), 1u);
    expect_same(read[i].frame->hands[0], complete_hand(frames()[i].hands[0], default_device_mount()));
  }
}

TEST(BagInput, the_devices_place_is_the_given_else_that_of_tf_static) {
  const auto palm = [](const Pose& device) {
    return complete_hand(frames()[0].hands[0], device).palm.position;
  };
  for (const bool given : {false, true}) {
    TestBag bag("placed.bag");
    bag.add_leap("/leap_motion/leap_device", frames()[0]);
    bag.add_static("world", "/table", {1, 0, 0});
    bag.add_static("table", "leap_hands", {0, 2, 0});
    const Pose device{{0, 0, given ? 3.0 : 0.0}, Quaternion::Identity()};
    const auto read = bag.read({}, given ? std::optional<Pose>(device) : std::nullopt);
    ASSERT_TRUE(read[0].frame);
    const Vector3 expected = given ? palm(device) : palm({{1, 2, 0}, Quaternion::Identity()});
    EXPECT_EQ(read[0].frame->hands[0].palm.position, expected);
  }
}

// A device on a headset: at each frame's stamp between the transforms about it, and the latest where none has
// come since.
TEST(BagInput, a_device_that_moves_is_where_tf_has_it_at_each_frames_stamp) {
  constexpr Nanoseconds kHalf = 5'000'000;
  TestBag bag("moving.bag");
  for (int i = 0; i < 6; ++i) {
    const Nanoseconds stamp = kBegin + 2 * kHalf * i;
    bag.add_transform("/tf", stamp, stamp, "world", "leap_hands", {0.1 * i, 0, 0});
    if (i == 0) continue;
    JointsFrame frame = frames()[0];
    frame.stamp = stamp - kHalf;
    bag.add_leap("/leap_motion/leap_device",
                 frame);  // recorded half a period before the transform that follows
    frame.stamp = stamp;
    bag.add_transform("/tf", stamp, stamp, "world", "other", {9, 9, 9});
    bag.add_leap("/leap_motion/leap_device", frame);
  }
  const auto read = bag.read();
  ASSERT_EQ(read.size(), 10u);
  const auto palm = [](double x) {
    return complete_hand(frames()[0].hands[0], Pose{{x, 0, 0}, Quaternion::Identity()}).palm.position;
  };
  for (int i = 1; i < 6; ++i) {
    const auto k = static_cast<std::size_t>(2 * i - 2);
    ASSERT_TRUE(read[k].frame && read[k + 1].frame) << read[k].detail;
    EXPECT_TRUE(read[k].frame->hands[0].palm.position.isApprox(palm(0.1 * (i - 1)), 1e-12)) << "the latest";
    EXPECT_TRUE(read[k + 1].frame->hands[0].palm.position.isApprox(palm(0.1 * i), 1e-12))
        << "the stamp's own";
  }
}

TEST(BagInput, hands_in_a_frame_that_nothing_places_are_refused_but_for_the_leaps_own) {
  for (const char* frame_id : {"camera", "tracker/left_hand", "", "leap_hands_2"}) {
    TestBag bag("unplaced.bag");
    bag.add_static("base", "camera", {});
    bag.add_leap("/leap_motion/leap_device", frames()[0], 0, frame_id);
    const auto read = bag.read();
    EXPECT_FALSE(read.at(0).frame) << frame_id;
    EXPECT_EQ(read[0].reason, "no transform");
    EXPECT_NE(read[0].detail.find("--hand-transform"), std::string::npos) << read[0].detail;
  }
  TestBag bag("world.bag");
  bag.add_leap("/leap_motion/leap_device", frames()[0], 0, "/world");
  const auto read = bag.read();
  ASSERT_TRUE(read.at(0).frame) << read[0].detail;
  EXPECT_EQ(read[0].frame->hands[0].palm.position, complete_hand(frames()[0].hands[0], Pose{}).palm.position);
}

TEST(BagInput, a_damaged_message_is_refused_and_the_rest_is_read) {
  TestBag bag("damaged.bag");
  bag.add_leap("/leap_motion/leap_device", frames()[0], 40);
  bag.add_leap("/leap_motion/leap_device", frames()[1]);
  const auto read = bag.read();
  ASSERT_EQ(read.size(), 2u);
  EXPECT_FALSE(read[0].frame);
  EXPECT_EQ(read[0].reason, DecodeError(DecodeError::Kind::malformed, "").reason());
  EXPECT_FALSE(read[0].detail.empty());
  EXPECT_TRUE(read[1].frame);
}

TEST(BagInput, a_hand_that_is_not_finite_is_refused) {
  JointsFrame bad = frames()[0];
  bad.hands[0].joints[1][4] = Vector3(0, NAN, 0);
  TestBag bag("nan.bag");
  bag.add_leap("/leap_motion/leap_device", bad);
  const auto read = bag.read();
  EXPECT_FALSE(read[0].frame);
  EXPECT_EQ(read[0].reason, "unusable hand");
  EXPECT_NE(read[0].detail.find("index tip"), std::string::npos) << read[0].detail;
}

TEST(BagInput, pose_arrays_are_taken_and_wrong_counts_refused) {
  geometry_msgs::PoseArray array;
  array.header.stamp = to_ros_time(kBegin);
  TestBag bag("poses.bag");
  bag.add("/hands/pose_array", kBegin, array);  // no hand
  array.poses.resize(20);
  bag.add("/hands/pose_array", kBegin + 1, array);
  const auto read = bag.read();
  ASSERT_TRUE(read[0].frame);
  EXPECT_TRUE(read[0].frame->hands.empty());
  EXPECT_FALSE(read[1].frame);
  EXPECT_EQ(read[1].reason, DecodeError(DecodeError::Kind::wrong_count, "").reason());
}

geometry_msgs::PoseArray pose_array(const JointsFrame& frame) {
  geometry_msgs::PoseArray array;
  array.header.stamp = to_ros_time(frame.stamp);
  array.header.frame_id = "leap_hands";
  for (const HandJoints& hand : frame.hands) {
    array.poses.resize(1);
    array.poses[0].position = to_message(hand.wrist.value());
    for (const auto& finger : hand.joints)
      for (std::size_t j = 1; j < finger.size(); ++j) {
        array.poses.emplace_back();
        array.poses.back().position = to_message(finger[j].value());
      }
  }
  return array;
}

TEST(BagInput, hands_on_topics_of_their_sides_come_together) {
  TestBag bag("sides.bag");
  for (std::size_t i = 0; i < 4; ++i) {
    const Nanoseconds stamp = frames()[i].stamp;
    bag.add("/hands/left/pose_array", stamp, pose_array(frames()[i]));
    bag.add("/hands/right/pose_array", stamp + 1000, pose_array(frames()[i]));
  }
  bag.bag.close();
  const ReplayInput opened = open_bag(bag.file, {}, {});
  FrameSource& input = *opened.frames;
  std::vector<HandFrame> read;
  while (const auto frame = input.next()) read.push_back(frame->frame.value());
  EXPECT_EQ(input.position(), input.size());
  // Until both have come twice, neither is known to go on.
  ASSERT_EQ(read.size(), 5u);
  for (std::size_t i : {3u, 4u}) {
    ASSERT_EQ(read[i].hands.size(), 2u);
    EXPECT_EQ(read[i].hands[0].side, Side::left);
    EXPECT_EQ(read[i].hands[1].side, Side::right);
  }
}

TEST(BagInput, joints_on_topics_of_other_names_are_of_the_side_that_is_told) {
  for (const bool is_left : {false, true}) {
    TestBag bag("names.bag");
    bag.add("/headset/joints", frames()[0].stamp, pose_array(frames()[0]));
    bag.add("/other/joints", frames()[1].stamp, pose_array(frames()[1]));
    bag.bag.close();
    HandOptions hands;
    hands.topics["headset/joints"] = is_left ? "hands/left/pose_array" : "hands/right/pose_array";
    const ReplayInput opened = open_bag(bag.file, {}, {}, hands);
    FrameSource& input = *opened.frames;
    const auto frame = input.next();
    ASSERT_TRUE(frame && frame->frame);
    EXPECT_EQ(frame->frame->hands.at(0).side, is_left ? Side::left : Side::right);
    EXPECT_FALSE(input.next());
  }
}

TEST(BagInput, lengths_in_another_unit_are_converted) {
  TestBag bag("unit.bag");
  geometry_msgs::PoseArray millimetres = pose_array(frames()[0]);
  for (auto& pose : millimetres.poses) {
    pose.position.x *= 1000.0;
    pose.position.y *= 1000.0;
    pose.position.z *= 1000.0;
  }
  bag.add("/hands/right/pose_array", kBegin, millimetres);
  bag.bag.close();
  HandOptions hands;
  hands.scale = 0.001;
  const ReplayInput converted = open_bag(bag.file, {}, {}, hands), as_it_is = open_bag(bag.file, {}, {});
  EXPECT_TRUE(converted.frames->next()->frame);
  EXPECT_NE(as_it_is.frames->next()->detail.find("as of millimetres"), std::string::npos);
}

/// With receipts 16 ms apart.
TEST(BagInput, a_first_frame_of_another_clock_is_left_out_and_a_step_is_taken_out) {
  TestBag bag("clock.bag");
  constexpr std::size_t kFrames = 60, kStep = 30;
  for (std::size_t i = 0; i < kFrames; ++i) {
    JointsFrame frame = frames()[i];
    if (i == 0) frame.stamp = 500'000'000'000'000'000;
    if (i >= kStep) frame.stamp -= 2'000'000'000;
    topic_tools::ShapeShifter message;
    write_leap(frame, "leap_hands", 0, 60.0f, message);
    bag.add("/leap_motion/leap_device", frames()[i].stamp, message);
  }
  const auto read = bag.read();
  ASSERT_EQ(read.size(), kFrames);
  EXPECT_EQ(read[0].reason, "first stamp of another clock");
  int steps = 0;
  for (std::size_t i = 1; i < kFrames; ++i) {
    for (const auto& [kind, what] : read[i].corrected) steps += kind == JointsInput::kStep;
    if (i == kStep) {
      EXPECT_EQ(read[i].reason, JointsInput::kStray);
      continue;
    }
    ASSERT_TRUE(read[i].frame);
    EXPECT_EQ(read[i].frame->stamp, frames()[i].stamp) << i;
  }
  EXPECT_EQ(steps, 1);
}

TEST(BagInput, hand_frames_in_world_keep_their_bits) {
  const HandFrame frame{kBegin, {complete_hand(frames()[0].hands[0], default_device_mount())}};
  TestBag bag("hand_frame.bag");
  bag.add("/some/hand_frame", kBegin, to_message(frame, "world"));
  bag.add("/some/hand_frame", kBegin + 1, to_message(frame, "elsewhere"));
  const auto read = bag.read();
  ASSERT_TRUE(read[0].frame);
  expect_same(read[0].frame->hands[0], frame.hands[0]);
  EXPECT_EQ(read[1].reason, "wrong frame");
  EXPECT_NE(read[1].detail.find("elsewhere"), std::string::npos);
}

TEST(BagInput, the_receipt_time_stands_in_for_a_stamp_that_was_not_set) {
  JointsFrame frame = frames()[0];
  frame.stamp = 0;
  TestBag bag("stamp.bag");
  topic_tools::ShapeShifter message;
  write_leap(frame, "leap_hands", 0, 60.0f, message);
  bag.add("/leap_motion/leap_device", kBegin, message);
  const auto read = bag.read();
  ASSERT_TRUE(read[0].frame);
  EXPECT_EQ(read[0].frame->stamp, kBegin);
}

TEST(BagInput, the_topic_is_the_usual_one_or_must_be_chosen) {
  const auto make = [](TestBag& bag, const std::vector<std::string>& topics) {
    for (const std::string& topic : topics) bag.add_leap(topic, frames()[0]);
    bag.add("/other", kBegin, std_msgs::Header());
  };
  TestBag usual("usual.bag");
  make(usual, {"/leap_motion/leap_device", "/b"});
  EXPECT_EQ(usual.read().size(), 1u);
  TestBag only("only.bag");
  make(only, {"/b"});
  EXPECT_EQ(only.read().size(), 1u);
  TestBag two("two.bag");
  make(two, {"/a", "/b"});
  EXPECT_NE(refusal(two).find("/a, /b"), std::string::npos);
  EXPECT_EQ(two.read(std::string("b")).size(), 1u);
  EXPECT_NE(refusal(two, std::string("/other")).find("'/other'"), std::string::npos);
  TestBag none("none.bag");
  make(none, {});
  EXPECT_NE(refusal(none).find("leap_motion/Human"), std::string::npos);
}

std::string message_of(const std::string& file) {
  try {
    const ReplayInput opened = open_bag(file, {}, {});
    FrameSource& input = *opened.frames;
    while (input.next()) {
    }
  } catch (const std::exception& error) {
    EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    EXPECT_EQ(std::string(error.what()).find(file), 0u) << error.what();
    return error.what();
  }
  return "";
}

TEST(BagInput, a_missing_bag_and_what_cannot_be_one_are_told_in_a_line) {
  test::Folder folder;
  EXPECT_EQ(message_of(folder / "missing.bag"),
            (folder / "missing.bag") + ": there is no such file; allowed: a bag that may be read");
  EXPECT_EQ(message_of("/tmp"), "/tmp: is no file; allowed: a bag that may be read");
}

/// Wherever four bytes of a bag are another length, number or place, it is read or refused: the bag library,
/// which takes them all on trust, does not end the program.
void expect_corrupt_bags_are_read_or_refused(rosbag::CompressionType compression) {
  TestBag bag("whole.bag");
  bag.bag.setCompression(compression);
  for (std::size_t i = 0; i < 8; ++i) bag.add_leap("/leap_motion/leap_device", frames()[i]);
  bag.add_static("world", "leap_hands", {});
  bag.bag.close();
  std::ifstream in(bag.file, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  ASSERT_EQ(message_of(bag.file), "");
  const std::string corrupt = bag.folder / "corrupt.bag";
  int refused = 0;
  for (std::size_t at = 0; at + 4 <= whole.size(); at += at < 4200 ? 151 : 127) {
    for (const char* bytes : {"\xFF\xFF\xFF\xFF", "\xFF\xFF\xFF\x7F", "\x10\x27\x00"}) {
      std::string changed = whole;
      changed.replace(at, 4, std::string(bytes, 4));
      std::ofstream(corrupt, std::ios::binary) << changed;
      refused += !message_of(corrupt).empty();
    }
  }
  for (std::size_t size = 0; size < whole.size(); size += 397) {
    std::ofstream(corrupt, std::ios::binary) << whole.substr(0, size);
    EXPECT_NE(message_of(corrupt), "") << size;
  }
  EXPECT_GT(refused, 20);
}

TEST(BagInput, corrupt_bags_are_read_or_refused) {
  expect_corrupt_bags_are_read_or_refused(rosbag::compression::Uncompressed);
}

TEST(BagInput, corrupt_compressed_bags_are_read_or_refused) {
  expect_corrupt_bags_are_read_or_refused(rosbag::compression::LZ4);
  expect_corrupt_bags_are_read_or_refused(rosbag::compression::BZ2);
}

TEST(BagInput, what_is_no_bag_is_named) {
  test::Folder folder;
  std::ofstream(folder / "text.bag") << "no bag";
  for (const char* name : {"text.bag", "missing.bag"}) {
    try {
      open_bag(folder / name, {}, {});
      ADD_FAILURE() << "no exception";
    } catch (const BagError& error) {
      EXPECT_NE(std::string(error.what()).find(name), std::string::npos) << error.what();
    }
  }
}

}  // namespace
}  // namespace mrhi
