#include "mr_hand_interaction/ros/leap_human.h"

#include <mr_hand_interaction/LeapAugust2019Human.h>
#include <mr_hand_interaction/LeapFebruary2020Human.h>
#include <mr_hand_interaction/LeapHuman.h>
#include <mr_hand_interaction/LeapMelodicHuman.h>

#include <map>
#include <memory>
#include <new>
#include <optional>

namespace mrhi {
namespace {

namespace msg = mr_hand_interaction;

/// Longest list or text of a message [bytes]; a driver's have less than 1 KB.
constexpr std::size_t kMaxListBytes = 64 * 1024;

/// Refuses lists longer than kMaxListBytes. roscpp resizes a list to the length that a message states before
/// it looks for the elements, so four bytes could claim all memory.
template <class T>
struct BoundedAllocator : std::allocator<T> {
  template <class U>
  struct rebind {
    using other = BoundedAllocator<U>;
  };

  BoundedAllocator() = default;
  template <class U>
  BoundedAllocator(const BoundedAllocator<U>& /*other*/) {}

  T* allocate(std::size_t count) {
    if (count > kMaxListBytes / sizeof(T)) throw std::bad_alloc();
    return std::allocator<T>::allocate(count);
  }
};
using Allocator = BoundedAllocator<char>;

[[noreturn]] void wrong_count(const std::string& what) {
  throw DecodeError(DecodeError::Kind::wrong_count, what);
}

template <class Message>
Vector3 vector(const Message& message) {
  return {message.x, message.y, message.z};
}

/// Drivers leave what they do not know at zero; no part of a hand can be exactly at the device's origin.
std::optional<Vector3> known(const Vector3& point) {
  return point == Vector3::Zero() ? std::nullopt : std::make_optional(point);
}
std::optional<float> known(float length) {
  return length == 0.0f ? std::nullopt : std::make_optional(length);
}

/// The elements of a list by their type number, 0..Size-1, each at most once.
template <std::size_t Size, class List>
std::array<const typename List::value_type*, Size> by_type(const List& list, const std::string& name) {
  if (list.size() > Size)
    wrong_count(name + " has " + std::to_string(list.size()) + " entries; at most " + std::to_string(Size));
  std::array<const typename List::value_type*, Size> found{};
  for (const auto& element : list) {
    const std::string has_type = name + " has type " + std::to_string(element.type);
    if (element.type >= Size) wrong_count(has_type + "; 0 to " + std::to_string(Size - 1) + " are known");
    if (found[element.type] != nullptr) wrong_count(has_type + " twice");
    found[element.type] = &element;
  }
  return found;
}

Vector3 wrist_of(const msg::LeapHand_<Allocator>& hand) {
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
  const auto fingers = by_type<kFingers>(message.finger_list, "leap_motion/Hand.finger_list");
  for (std::size_t f = 0; f < kFingers; ++f) {
    if (fingers[f] == nullptr) continue;
    hand.finger_width[f] = known(fingers[f]->width);
    const auto bones = by_type<kBonesPerFinger>(fingers[f]->bone_list, "leap_motion/Finger.bone_list");
    for (std::size_t b = 0; b < kBonesPerFinger; ++b) {
      if (bones[b] == nullptr) continue;
      // A bone starts where the one before it ends; what is not finite must not be covered up.
      auto& joint = hand.joints[f][b];
      if (!joint || joint->allFinite()) joint = vector(bones[b]->bone_start.position);
      hand.joints[f][b + 1] = vector(bones[b]->bone_end.position);
    }
  }
  return hand;
}

template <class Human>
Human deserialised(std::vector<std::uint8_t>& bytes) {
  const auto refuse = [&](const std::string& what) {
    throw DecodeError(DecodeError::Kind::malformed,
                      "leap_motion/Human of " + std::to_string(bytes.size()) + " bytes " + what);
  };
  Human human;
  ros::serialization::IStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  try {
    if (bytes.empty()) ros::serialization::throwStreamOverrun();  // roscpp would add to a null pointer
    ros::serialization::deserialize(stream, human);
  } catch (const ros::serialization::StreamOverrunException&) {
    refuse("ends before all of its fields");
  } catch (const std::bad_alloc&) {
    refuse("has a list or text of more than " + std::to_string(kMaxListBytes) + " bytes");
  }
  if (stream.getLength() != 0)
    refuse("has " + std::to_string(stream.getLength()) + " after all of its fields");
  return human;
}

template <class Human>
LeapFrame frame_of(std::vector<std::uint8_t>& bytes) {
  const auto human = deserialised<Human>(bytes);
  LeapFrame frame;
  frame.frame_id.assign(human.header.frame_id.begin(), human.header.frame_id.end());
  frame.sequence = human.header.seq;
  frame.joints.stamp = static_cast<Nanoseconds>(human.header.stamp.toNSec());
  for (const auto& [hand, side] :
       {std::make_pair(&human.right_hand, Side::right), {&human.left_hand, Side::left}}) {
    HandJoints joints = joints_of(*hand, side);
    if (hand->is_present) frame.joints.hands.push_back(std::move(joints));
  }
  return frame;
}

using Read = LeapFrame (*)(std::vector<std::uint8_t>&);

/// Reads a version of the message, which its MD5 identifies: it does not depend on the types' names.
template <class Human>
std::pair<const std::string, Read> version() {
  return {ros::message_traits::MD5Sum<Human>::value(), &frame_of<Human>};
}

}  // namespace

const char* DecodeError::reason() const {
  switch (kind_) {
    case Kind::unknown_version:
      return "unknown message version";
    case Kind::malformed:
      return "malformed message";
    case Kind::wrong_count:
      return "wrong finger or bone count";
  }
  return "";
}

LeapFrame read_leap(const std::string& md5, std::vector<std::uint8_t> bytes) {
  static const std::map<std::string, Read> versions{
      version<msg::LeapHuman_<Allocator>>(), version<msg::LeapFebruary2020Human_<Allocator>>(),
      version<msg::LeapAugust2019Human_<Allocator>>(), version<msg::LeapMelodicHuman_<Allocator>>()};
  const auto found = versions.find(md5);
  if (found != versions.end()) return found->second(bytes);
  std::string allowed;
  for (const auto& [known_md5, read] : versions) allowed += (allowed.empty() ? "" : ", ") + known_md5;
  throw DecodeError(DecodeError::Kind::unknown_version,
                    "unknown version of leap_motion/Human: md5 " + md5 + "; allowed: " + allowed);
}

}  // namespace mrhi
