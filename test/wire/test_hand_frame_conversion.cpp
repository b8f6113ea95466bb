#include "mr_hand_interaction/ros/hand_frame_conversion.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

#include "mr_hand_interaction/ros/leap_human.h"
#include "ros/result_messages.h"
#include "ros/tracker_reader.h"
#include "sample_hands.h"

namespace mrhi {
namespace {

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();

/// Hands of points in the usual order of their number.
JointsFrame hands_from_points(const TrackedPoints& tracked, Side side) {
  const auto order = [](std::size_t size, const Vector3*) -> const JointOrder& { return *usual_order(size); };
  return joints_from_points(tracked, side, order);
}

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

TEST(HandFrameConversion, AWristThatIsNotKnownIsPlacedAsAnAdults) {
  HandFrame sent = sample_frame();
  for (Hand& hand : sent.hands) hand.palm.position += Vector3(1.0, 0.0, 0.0);
  auto message = to_message(sent, "world");
  for (auto& hand : message.hands) hand.wrist = geometry_msgs::Point();
  const HandFrame back = from_message(message);
  for (std::size_t h = 0; h < sent.hands.size(); ++h)
    EXPECT_LT((back.hands[h].wrist - sent.hands[h].wrist - Vector3(1.0, 0.0, 0.0)).norm(), 0.015);
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

/// As a tracker gives it that has so many joints.
void add_hand(const HandJoints& hand, std::size_t joints, TrackedPoints& tracked) {
  std::vector<Vector3>& points = tracked.points;
  if (joints == 26) points.push_back(hand.palm_centre.value());
  points.push_back(hand.wrist.value());
  for (std::size_t f = 0; f < kFingers; ++f)
    for (std::size_t j = f == 0 || joints == 21 ? 1 : 0; j < 5; ++j)
      points.push_back(hand.joints[f][j].value());
}

TrackedPoints tracked_hand(const HandJoints& hand, std::size_t joints) {
  TrackedPoints tracked;
  tracked.header.stamp = ros::Time(3, 5);
  add_hand(hand, joints, tracked);
  EXPECT_EQ(tracked.points.size(), joints);
  return tracked;
}

void expect_joints(const HandJoints& hand, const HandJoints& sent, bool metacarpal_bases) {
  EXPECT_EQ(hand.side, sent.side);
  EXPECT_EQ(hand.wrist, sent.wrist);
  EXPECT_FALSE(hand.palm_centre);
  for (std::size_t f = 0; f < kFingers; ++f) {
    EXPECT_EQ(hand.joints[f][0], f > 0 && metacarpal_bases ? sent.joints[f][0] : std::nullopt);
    for (std::size_t j = 1; j < 5; ++j) EXPECT_EQ(hand.joints[f][j], sent.joints[f][j]);
  }
}

TEST(TrackedPoints, TwentyOneJointsAreTheHandWithoutMetacarpalBases) {
  const HandJoints sent = sample_hand(Side::left);
  const JointsFrame frame = hands_from_points(tracked_hand(sent, 21), Side::left);
  EXPECT_EQ(frame.stamp, 3000000005);
  ASSERT_EQ(frame.hands.size(), 1u);
  const HandJoints& hand = frame.hands[0];
  expect_joints(hand, sent, false);
  ASSERT_EQ(defect(hand), "");
  const Hand completed = complete_hand(hand, Pose());
  // The palm's centre and direction come from wrist and knuckles alone: 1 cm, 10 degrees.
  EXPECT_LT((completed.palm.position - sent.palm_centre.value()).norm(), 0.010);
  const Hand whole = complete_hand(sent, Pose());
  EXPECT_LT(completed.palm.orientation.angularDistance(whole.palm.orientation), 0.175);
}

TEST(TrackedPoints, NoPointsIsAFrameWithNoHandAndOtherCountsAreRefused) {
  TrackedPoints message;
  EXPECT_TRUE(hands_from_points(message, Side::right).hands.empty());
  for (std::size_t count : {1u, 20u, 22u, 27u, 41u, 46u, 63u}) {
    message.points.resize(count);
    EXPECT_THROW(hands_from_points(message, Side::right), DecodeError);
  }
}

TEST(TrackedPoints, TwentyFiveAndTwentySixJointsHaveTheMetacarpalBases) {
  const HandJoints sent = sample_hand(Side::right);
  for (std::size_t joints : {25u, 26u}) {
    const JointsFrame frame = hands_from_points(tracked_hand(sent, joints), Side::right);
    ASSERT_EQ(frame.hands.size(), 1u);
    expect_joints(frame.hands[0], sent, true);
    const Hand completed = complete_hand(frame.hands[0], Pose()), whole = complete_hand(sent, Pose());
    // The centre that the tracker gives of the palm is not used: 1 cm.
    EXPECT_LT((completed.palm.position - whole.palm.position).norm(), 0.010);
    EXPECT_LT(completed.palm.orientation.angularDistance(whole.palm.orientation), 0.05);
  }
}

// As of a driver that gives bones alone.
TEST(TrackedPoints, MetacarpalBasesStandInForAWristThatIsMissing) {
  const HandJoints sent = sample_hand(Side::left);
  TrackedPoints tracked = tracked_hand(sent, 25);
  const Hand whole = complete_hand(hands_from_points(tracked, Side::left).hands.at(0), Pose());
  tracked.points[0].setConstant(NAN);
  const Hand hand = complete_hand(hands_from_points(tracked, Side::left).hands.at(0), Pose());
  EXPECT_EQ(hand.palm.position, whole.palm.position);
  for (std::size_t i = 0; i < kCapsules; ++i) EXPECT_EQ(hand.capsules[i].start, whole.capsules[i].start);
  EXPECT_LT((hand.wrist - whole.wrist).norm(), 0.015);  // by the proportions of a mean hand
}

TEST(TrackedPoints, TwiceAsManyJointsAreLeftAndRight) {
  for (std::size_t joints : {21u, 25u, 26u}) {
    TrackedPoints message;
    add_hand(sample_hand(Side::left), joints, message);
    EXPECT_FALSE(has_both_hands(message));
    add_hand(sample_hand(Side::right), joints, message);
    EXPECT_TRUE(has_both_hands(message));
    const JointsFrame frame = hands_from_points(message, Side::right);
    ASSERT_EQ(frame.hands.size(), 2u);
    expect_joints(frame.hands[0], sample_hand(Side::left), joints != 21);
    expect_joints(frame.hands[1], sample_hand(Side::right), joints != 21);
    EXPECT_NE(frame.hands[0].id, frame.hands[1].id);
    for (std::size_t i = 0; i < joints; ++i) message.points[i].y() = NAN;
    EXPECT_EQ(hands_from_points(message, Side::right).hands.size(), 1u);
  }
}

TEST(TrackedPoints, AJointThatIsNotFiniteIsMissingAndAHandOfNothingElseIsNotThere) {
  const HandJoints sent = sample_hand(Side::right);
  TrackedPoints message = tracked_hand(sent, 26);
  message.points[9].z() = NAN;  // the index finger's distal joint
  const HandJoints hand = hands_from_points(message, Side::right).hands.at(0);
  EXPECT_FALSE(hand.joints[1][3]);
  EXPECT_EQ(hand.joints[1][4], sent.joints[1][4]);
  EXPECT_EQ(defect(hand), "");
  EXPECT_FALSE(complete_hand(hand, Pose()).has(capsule_index(1, 3)));
  for (Vector3& point : message.points) point.x() = NAN;
  EXPECT_TRUE(hands_from_points(message, Side::right).hands.empty());
  message = tracked_hand(sent, 21);
  message.points[4].x() = INFINITY;
  EXPECT_FALSE(hands_from_points(message, Side::right).hands.at(0).joints[0][4]);
}

TEST(TrackedPoints, EveryMessageSaysTheSame) {
  const TrackedPoints sent = tracked_hand(sample_hand(Side::right), 26);
  geometry_msgs::PoseArray poses;
  sensor_msgs::PointCloud cloud;
  poses.header = cloud.header = sent.header;
  for (const Vector3& point : sent.points) {
    poses.poses.emplace_back();
    poses.poses.back().position = to_message(point);
    cloud.points.emplace_back();
    cloud.points.back().x = static_cast<float>(point.x());
    cloud.points.back().y = static_cast<float>(point.y());
    cloud.points.back().z = static_cast<float>(point.z());
  }
  EXPECT_EQ(tracked_points(poses).points, sent.points);
  const TrackedPoints read = tracked_points(cloud);
  EXPECT_EQ(read.header.stamp, sent.header.stamp);
  ASSERT_EQ(read.points.size(), sent.points.size());
  for (std::size_t i = 0; i < read.points.size(); ++i)
    EXPECT_EQ(read.points[i].cast<float>(), sent.points[i].cast<float>());
}

TEST(TrackedPoints, TopicsAndFramesNameTheSide) {
  for (const char* const name :
       {"/hands/left/pose_array", "hands/left/point_cloud", "left/pose_array", "/leapmotion/hands/left"})
    EXPECT_EQ(side_of_topic(name), Side::left) << name;
  EXPECT_EQ(side_of_topic("hands/right/pose_array"), Side::right);
  for (const char* const name : {"/hands/pose_array", "/upright/pose_array", "/left/a/b", ""})
    EXPECT_FALSE(side_of_topic(name)) << name;
  EXPECT_EQ(side_of_frame("headset/left_hand"), Side::left);
  EXPECT_EQ(side_of_frame("right_hand"), Side::right);
  for (const char* const name : {"left_camera", "camera_left", ""}) EXPECT_FALSE(side_of_frame(name)) << name;
}

TEST(TrackedPoints, AHandGivenOutIsTheHandTakenIn) {
  const Hand hand = complete_hand(sample_hand(Side::left), Pose());
  const geometry_msgs::PoseArray message = pose_array_message(hand, std_msgs::Header());
  ASSERT_EQ(message.poses.size(), 21u);
  const Hand again =
      complete_hand(hands_from_points(tracked_points(message), Side::left).hands.at(0), Pose());
  for (int i = 0; i < kPhalanges; ++i) {
    if (bone_of(i) == 0) continue;
    const Capsule &a = hand.capsules[static_cast<std::size_t>(i)],
                  &b = again.capsules[static_cast<std::size_t>(i)];
    EXPECT_EQ(a.start, b.start);
    EXPECT_EQ(a.end, b.end);
    const Pose tip = from_message(message.poses[static_cast<std::size_t>(1 + finger_of(i) * 4 + bone_of(i))]);
    EXPECT_GT((tip.orientation * Vector3::UnitX()).dot((a.end - a.start).normalized()), 1.0 - 1e-9);
  }
  Hand without = hand;
  without.capsules[static_cast<std::size_t>(capsule_index(2, 3))].radius = 0.0;
  EXPECT_TRUE(std::isnan(pose_array_message(without, std_msgs::Header()).poses[12].position.x));
}

}  // namespace
}  // namespace mrhi
