#include "mr_hand_interaction/ros/leap_human.h"

#include <mr_hand_interaction/LeapAugust2019Human.h>
#include <mr_hand_interaction/LeapControllerHand.h>
#include <mr_hand_interaction/LeapFebruary2020Human.h>
#include <mr_hand_interaction/LeapHuman.h>
#include <mr_hand_interaction/LeapMelodicHuman.h>

#include <boost/algorithm/string/replace.hpp>
#include <map>
#include <optional>
#include <stdexcept>

#include "../text/text.h"
#include "leap_human_publisher.h"
#include "mr_hand_interaction/ros/hand_frame_conversion.h"
#include "tracker_reader.h"

namespace mrhi {
namespace {

namespace msg = mr_hand_interaction;

[[noreturn]] void wrong_count(const std::string& what) {
  throw DecodeError(DecodeError::Kind::wrong_count, what);
}

template <class Message>
Vector3 vector(const Message& message) {
  return {message.x, message.y, message.z};
}
Vector3 vector(const geometry_msgs::Pose_<Bounded>& pose) {
  return vector(pose.position);
}

/// Drivers leave unknown points at zero; no part of a hand is exactly at the device's origin.
std::optional<Vector3> known(const Vector3& point) {
  return point == Vector3::Zero() ? std::nullopt : std::make_optional(point);
}
std::optional<float> known(float length) {
  return length == 0.0f ? std::nullopt : std::make_optional(length);
}

/// Elements of a list by their type, 0..Size-1, each at most once. `package`, `name`: for errors.
template <std::size_t Size, class List>
std::array<const typename List::value_type*, Size> by_type(const List& list, const char* package,
                                                           const char* name) {
  const auto refuse = [&](const std::string& what) { wrong_count(package + (name + (" has " + what))); };
  if (list.size() > Size) refuse(std::to_string(list.size()) + " entries; at most " + std::to_string(Size));
  std::array<const typename List::value_type*, Size> found{};
  for (const auto& element : list) {
    const auto type = [&] { return "type " + std::to_string(element.type); };
    if (element.type >= Size) refuse(type() + "; 0 to " + std::to_string(Size - 1) + " are known");
    if (found[element.type] != nullptr) refuse(type() + " twice");
    found[element.type] = &element;
  }
  return found;
}

Vector3 wrist_of(const msg::LeapHand_<Bounded>& hand) {
  return vector(hand.arm.wrist.position);
}
template <class Hand>
Vector3 wrist_of(const Hand& hand) {
  const auto& wrist = hand.wrist_position;
  if (wrist.empty()) return Vector3::Zero();
  if (wrist.size() != 3)
    wrong_count("leap_motion/Hand.wrist_position has " + std::to_string(wrist.size()) +
                " numbers; 3, or none if it is not known");
  return {wrist[0], wrist[1], wrist[2]};
}

float width_of(const msg::LeapControllerFinger_<Bounded>&) {
  return 0.0f;
}
float width_of(const msg::LeapControllerBone_<Bounded>&) {
  return 0.0f;
}
template <class Part>
float width_of(const Part& part) {
  return part.width;
}

/// Joints of the fingers as in both drivers' messages. Points at zero stay so as placeholders.
template <class Hand>
void read_fingers(const Hand& message, const char* package, HandJoints& hand) {
  const auto fingers = by_type<kFingers>(message.finger_list, package, "/Hand.finger_list");
  for (std::size_t f = 0; f < kFingers; ++f) {
    if (fingers[f] == nullptr) continue;
    hand.finger_width[f] = known(width_of(*fingers[f]));
    const auto bones = by_type<kBonesPerFinger>(fingers[f]->bone_list, package, "/Finger.bone_list");
    for (std::size_t b = 0; b < kBonesPerFinger; ++b) {
      if (bones[b] == nullptr) continue;
      // A bone starts where the previous one ends; a value that is not finite must not be overwritten.
      auto& joint = hand.joints[f][b];
      if (!joint || joint->allFinite()) joint = vector(bones[b]->bone_start);
      hand.joints[f][b + 1] = vector(bones[b]->bone_end);
      hand.bone_width[f][b] = known(width_of(*bones[b]));
    }
  }
}

template <class Hand>
HandJoints joints_of(const Hand& message, Side side) {
  HandJoints hand;
  hand.id = static_cast<std::uint32_t>(message.lmc_hand_id);
  hand.side = side;
  hand.confidence = message.confidence;
  hand.grab_strength = message.grab_strength;
  hand.pinch_strength = message.pinch_strength;
  hand.palm_centre = known(vector(message.palm_center));
  hand.palm_width = known(message.palm_width);
  hand.wrist = known(wrist_of(message));
  read_fingers(message, "leap_motion", hand);
  return hand;
}

template <class Header>
LeapFrame frame_with(const Header& header) {
  return {{header.frame_id.begin(), header.frame_id.end()}, header.seq, {from_ros_time(header.stamp), {}}};
}

template <class Human>
LeapFrame frame_of(std::vector<std::uint8_t>& bytes) {
  const Human& human = deserialised<Human>("leap_motion/Human", bytes);
  LeapFrame frame = frame_with(human.header);
  const auto take = [&frame](const auto& hand, Side side) {
    HandJoints joints = joints_of(hand, side);
    if (hand.is_present) frame.joints.hands.push_back(std::move(joints));
  };
  take(human.right_hand, Side::right);
  take(human.left_hand, Side::left);
  return frame;
}

using Read = LeapFrame (*)(std::vector<std::uint8_t>&);

/// Reads a version of the message, identified by its MD5, which does not depend on the types' names.
template <class Human>
std::pair<const std::string, Read> version() {
  return {ros::message_traits::MD5Sum<Human>::value(), &frame_of<Human>};
}

const std::map<std::string, Read>& versions() {
  static const std::map<std::string, Read> all{
      version<msg::LeapHuman_<Bounded>>(), version<msg::LeapFebruary2020Human_<Bounded>>(),
      version<msg::LeapAugust2019Human_<Bounded>>(), version<msg::LeapMelodicHuman_<Bounded>>()};
  return all;
}

const HandJoints* hand_of(const JointsFrame& frame, Side side) {
  const HandJoints* found = nullptr;
  for (const HandJoints& hand : frame.hands) {
    if (hand.side != side) continue;
    if (found != nullptr)
      throw std::invalid_argument("a leap_motion/Human message holds one hand of each side");
    found = &hand;
  }
  return found;
}

/// Unit vectors towards the fingers and out of the palm, as the driver has; zero if a joint is missing.
struct PalmAxes {
  Vector3 direction = Vector3::Zero(), normal = Vector3::Zero();

  explicit PalmAxes(const HandJoints& hand) {
    const auto &index = hand.joints[1][1], &middle = hand.joints[2][1], &little = hand.joints[4][1];
    const auto& wrist = hand.wrist ? hand.wrist : hand.joints[2][0];
    if (!index || !middle || !little || !wrist) return;
    direction = (*middle - *wrist).normalized();
    const Vector3 across = *little - *index;
    normal = (hand.side == Side::right ? direction.cross(across) : across.cross(direction)).normalized();
    direction = (direction - direction.dot(normal) * normal).normalized();
  }
};

/// Orientation of a bone as the driver computes it: from the transpose of its basis (x, y, z in columns).
Quaternion driver_orientation(const Vector3& along, const Vector3& palm_normal) {
  const Vector3 backwards = -along;
  const Vector3 side = (-palm_normal).cross(backwards);
  if (side.norm() < 1e-9) return Quaternion::Identity();
  Matrix3 basis;
  basis.col(0) = side.normalized();
  basis.col(2) = backwards.normalized();
  basis.col(1) = basis.col(2).cross(basis.col(0));
  return Quaternion(basis).conjugate();
}

std::vector<float> floats(const Vector3& v) {
  return {static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())};
}

msg::LeapArm arm_message(const std_msgs::Header& header, const HandJoints& hand, const PalmAxes& palm) {
  constexpr double kForearm = 0.25;  // [m]
  const Vector3 wrist = hand.wrist.value_or(Vector3::Zero());
  const Vector3 elbow = hand.wrist ? Vector3(wrist - kForearm * palm.direction) : wrist;
  const Quaternion orientation = driver_orientation(palm.direction, palm.normal);
  msg::LeapArm arm;
  arm.header = header;
  arm.elbow = to_message(Pose{elbow, orientation});
  arm.wrist = to_message(Pose{wrist, orientation});
  arm.center = floats(0.5 * (elbow + wrist));
  arm.direction = vector_message(palm.direction);
  return arm;
}

/// A finger with those of its bones whose ends are known.
msg::LeapFinger finger_message(const std_msgs::Header& header, const HandJoints& hand, std::size_t number,
                               const PalmAxes& palm) {
  msg::LeapFinger finger;
  finger.header = header;
  finger.lmc_finger_id = static_cast<std::int32_t>(10 * hand.id + number);
  finger.type = static_cast<std::uint8_t>(number);
  finger.width = hand.finger_width[number].value_or(0.0f);
  double length = 0.0;
  const auto& joints = hand.joints[number];
  for (std::size_t b = 0; b < kBonesPerFinger; ++b) {
    if (!joints[b] || !joints[b + 1]) continue;
    const Vector3 along = *joints[b + 1] - *joints[b];
    const Quaternion orientation = driver_orientation(along, palm.normal);
    if (b > 0) length += along.norm();
    msg::LeapBone bone;
    bone.header = header;
    bone.type = static_cast<std::uint8_t>(b);
    bone.length = static_cast<float>(along.norm());
    bone.width = finger.width;
    bone.bone_start = to_message(Pose{*joints[b], orientation});
    bone.bone_end = to_message(Pose{*joints[b + 1], orientation});
    bone.center = floats(0.5 * (*joints[b] + *joints[b + 1]));
    finger.bone_list.push_back(bone);
  }
  finger.length = static_cast<float>(length);
  return finger;
}

msg::LeapHand hand_message(const std_msgs::Header& header, const HandJoints* present) {
  msg::LeapHand message;
  message.header = header;
  const HandJoints hand = present != nullptr ? *present : HandJoints();
  const PalmAxes palm(hand);
  message.arm = arm_message(header, hand, palm);
  if (present == nullptr) return message;
  message.is_present = 1;
  message.lmc_hand_id = static_cast<std::int32_t>(hand.id);
  message.confidence = hand.confidence;
  message.direction = vector_message(palm.direction);
  message.normal = vector_message(palm.normal);
  message.grab_strength = hand.grab_strength;
  message.pinch_strength = hand.pinch_strength;
  message.palm_center = to_message(hand.palm_centre.value_or(Vector3::Zero()));
  message.palm_width = hand.palm_width.value_or(0.0f);
  for (std::size_t finger = 0; finger < kFingers; ++finger) {
    message.finger_list.push_back(finger_message(header, hand, finger, palm));
    if (message.finger_list.back().bone_list.empty()) message.finger_list.pop_back();
  }
  return message;
}

msg::LeapHuman human_message(const JointsFrame& frame, const std_msgs::Header& header, float rate) {
  msg::LeapHuman human;
  human.header = header;
  human.lmc_frame_id = static_cast<std::int32_t>(header.seq);
  human.right_hand = hand_message(header, hand_of(frame, Side::right));
  human.left_hand = hand_message(header, hand_of(frame, Side::left));
  human.nr_of_hands = static_cast<std::int32_t>(frame.hands.size());
  human.nr_of_fingers =
      static_cast<std::int32_t>(human.right_hand.finger_list.size() + human.left_hand.finger_list.size());
  human.current_frames_per_second = rate;
  return human;
}

}  // namespace

/// The driver sets no confidence.
LeapFrame read_leap_controller(std::vector<std::uint8_t> bytes) {
  const auto& message = deserialised<msg::LeapControllerHand_<Bounded>>("leap_motion_controller/Hand", bytes);
  HandJoints hand;
  hand.id = static_cast<std::uint32_t>(message.lmc_hand_id);
  hand.grab_strength = message.grab_strength;
  hand.pinch_strength = message.pinch_strength;
  hand.palm_centre = known(vector(message.palm_center));
  read_fingers(message, "leap_motion_controller", hand);
  LeapFrame frame = frame_with(message.header);
  frame.joints.hands.push_back(std::move(hand));
  return frame;
}

const char* DecodeError::reason() const {
  static const char* const reasons[] = {"unknown message version", "malformed message",
                                        "wrong finger or bone count", "unknown order of joints"};
  return reasons[static_cast<std::size_t>(kind_)];
}

std::vector<std::string> leap_versions() {
  std::vector<std::string> md5s;
  for (const auto& [md5, read] : versions()) md5s.push_back(md5);
  return md5s;
}

LeapFrame read_leap(const std::string& md5, std::vector<std::uint8_t> bytes) {
  const auto found = versions().find(md5);
  if (found != versions().end()) return found->second(bytes);
  throw DecodeError(DecodeError::Kind::unknown_version, "unknown version of leap_motion/Human: md5 " + md5 +
                                                            "; allowed: " + text::joined(leap_versions()));
}

void write_leap(const JointsFrame& frame, const std::string& frame_id, std::uint32_t sequence, float rate,
                topic_tools::ShapeShifter& message) {
  using Human = msg::LeapHuman;
  // The driver's names: recordings are also read without this package.
  static const std::string definition = boost::replace_all_copy(
      std::string(ros::message_traits::definition<Human>()), "mr_hand_interaction/Leap", "leap_motion/");
  std_msgs::Header header;
  header.seq = sequence;
  header.stamp = to_ros_time(frame.stamp);
  header.frame_id = frame_id;
  const Human human = human_message(frame, header, rate);
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(human));
  ros::serialization::OStream out(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(out, human);
  ros::serialization::IStream in(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  message.morph(ros::message_traits::md5sum<Human>(), "leap_motion/Human", definition, "");
  message.read(in);
}

}  // namespace mrhi
