#include "mr_hand_interaction/ros/leap_human.h"

#include <mr_hand_interaction/LeapAugust2019Human.h>
#include <mr_hand_interaction/LeapControllerHand.h>
#include <mr_hand_interaction/LeapFebruary2020Human.h>
#include <mr_hand_interaction/LeapHuman.h>
#include <mr_hand_interaction/LeapMelodicHuman.h>

#include <map>
#include <optional>

#include "../text/text.h"
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

/// Drivers leave unknown points at zero; no part of a hand is exactly at the device's origin.
std::optional<Vector3> known(const Vector3& point) {
  return point == Vector3::Zero() ? std::nullopt : std::make_optional(point);
}
std::optional<float> known(float length) {
  return length == 0.0f ? std::nullopt : std::make_optional(length);
}

/// Elements of a list by their type number, 0..Size-1, each at most once. `package` and `name` are for
/// errors.
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

Vector3 position(const geometry_msgs::Pose_<Bounded>& pose) {
  return vector(pose.position);
}
Vector3 position(const geometry_msgs::Point_<Bounded>& point) {
  return vector(point);
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
      if (!joint || joint->allFinite()) joint = position(bones[b]->bone_start);
      hand.joints[f][b + 1] = position(bones[b]->bone_end);
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
  return {{header.frame_id.begin(), header.frame_id.end()},
          header.seq,
          {static_cast<Nanoseconds>(header.stamp.toNSec()), {}}};
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

}  // namespace

/// The driver sets no confidence.
LeapFrame read_leap_controller(std::vector<std::uint8_t> bytes) {
  const auto& message = deserialised<msg::LeapControllerHand_<Bounded>>("leap_motion_controller/Hand", bytes);
  HandJoints hand;
  hand.id = static_cast<std::uint32_t>(message.lmc_hand_id);
  hand.grab_strength = message.grab_strength;
  hand.pinch_strength = message.pinch_strength;
  hand.palm_centre = known(position(message.palm_center));
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

}  // namespace mrhi
