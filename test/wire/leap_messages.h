#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// The published versions of leap_motion/Human, newest first.
enum class LeapVersion { head, february_2020, august_2019, release_0_0_14 };
inline const std::vector<LeapVersion> kLeapVersions{LeapVersion::head, LeapVersion::february_2020,
                                                    LeapVersion::august_2019, LeapVersion::release_0_0_14};

/// The full definition as a connection header carries it, written from the drivers' field lists.
inline std::string leap_definition(LeapVersion version) {
  const std::string block = "\n" + std::string(80, '=') + "\nMSG: ";
  std::string hand =
      "Header header\nint32 lmc_hand_id\nbool is_present\nbool valid_gestures\nfloat32 time_visible\n"
      "float32 confidence\nfloat32 roll\nfloat32 pitch\nfloat32 yaw\n";
  if (version != LeapVersion::release_0_0_14)
    hand += "geometry_msgs/Vector3 direction\ngeometry_msgs/Vector3 normal\n";
  hand +=
      "float32 grab_strength # 0 to 1\nfloat32 pinch_strength\nfloat32[] palm_velocity\n"
      "geometry_msgs/Point palm_center\nfloat32 palm_width\nfloat32 sphere_radius\nfloat32[] sphere_center\n";
  if (version != LeapVersion::head) hand += "float32[] wrist_position\n";
  if (version == LeapVersion::february_2020) hand += "float32[] elbow_position\n";
  hand += "string to_string\nFinger[] finger_list\nGesture[] gesture_list\n";
  if (version == LeapVersion::head) hand += "Arm arm\n";
  std::string text =
      "# One frame of the device\nHeader header\nint32 lmc_frame_id\nint32 nr_of_hands\nint32 nr_of_fingers\n"
      "int32 nr_of_gestures\nfloat32 current_frames_per_second\nstring to_string\nHand right_hand\nHand "
      "left_hand\n";
  text += block + "std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n" + block +
          "leap_motion/Hand\n" + hand;
  text += block +
          "leap_motion/Finger\nuint8 TYPE_THUMB=0\nstring NOTE= a # b\nHeader header\nint32 lmc_finger_id\n"
          "uint8 type\nfloat32 length\nfloat32 width\nstring to_string\nBone[] bone_list\n";
  text += block +
          "leap_motion/Bone\nHeader header\nuint8 type\nfloat32 length\nfloat32 width\nstring to_string\n"
          "geometry_msgs/Pose bone_start\ngeometry_msgs/Pose bone_end\nfloat32[] center\n";
  text += block +
          "leap_motion/Gesture\nint32 lmc_gesture_id\nbool is_valid\nint64 duration_us\nfloat32 duration_s\n"
          "int32 gesture_state\nint32 gesture_type\nstring to_string\nint32[] pointable_ids\n";
  if (version == LeapVersion::head)
    text += block +
            "leap_motion/Arm\nHeader header\ngeometry_msgs/Pose elbow\ngeometry_msgs/Pose wrist\n"
            "float32[] center\ngeometry_msgs/Vector3 direction\n";
  for (const char* name : {"Vector3", "Point"})
    text += block + "geometry_msgs/" + name + "\nfloat64 x\nfloat64 y\nfloat64 z\n";
  text += block + "geometry_msgs/Quaternion\nfloat64 x\nfloat64 y\nfloat64 z\nfloat64 w\n";
  return text + block + "geometry_msgs/Pose\nPoint position\nQuaternion orientation\n";
}

/// Writes messages byte by byte, independently of the decoder.
class LeapWriter {
 public:
  explicit LeapWriter(LeapVersion version) : version_(version) {}

  std::vector<std::uint8_t> human(const JointsFrame& frame) {
    bytes_.clear();
    header(frame.stamp, "leap_hands");
    put<std::int32_t>(17), put<std::int32_t>(static_cast<std::int32_t>(frame.hands.size()));
    put<std::int32_t>(5), put<std::int32_t>(0), put(115.0f), text("a frame");
    for (Side side : {Side::right, Side::left}) {
      const HandJoints* found = nullptr;
      for (const HandJoints& hand : frame.hands)
        if (hand.side == side) found = &hand;
      write_hand(found);
    }
    return bytes_;
  }

  std::vector<std::uint8_t> extra_bone;  ///< type numbers of bones that the index finger has besides its own
  std::vector<std::uint8_t> extra_finger;

 private:
  template <class Number>
  void put(Number value) {
    const auto* first = reinterpret_cast<const std::uint8_t*>(&value);
    bytes_.insert(bytes_.end(), first, first + sizeof value);
  }
  void text(const std::string& value) {
    put(static_cast<std::uint32_t>(value.size()));
    bytes_.insert(bytes_.end(), value.begin(), value.end());
  }
  void header(Nanoseconds stamp, const std::string& frame_id) {
    put<std::uint32_t>(3), put(static_cast<std::uint32_t>(stamp / 1000000000));
    put(static_cast<std::uint32_t>(stamp % 1000000000)), text(frame_id);
  }
  void point(const Vector3& p) { put(p.x()), put(p.y()), put(p.z()); }
  void pose(const Vector3& p) { point(p), put(0.9), put(-0.1), put(0.3), put(0.2); }
  void floats(const std::vector<float>& values) {
    put(static_cast<std::uint32_t>(values.size()));
    for (float value : values) put(value);
  }
  void vector(const Vector3& v) {
    floats({static_cast<float>(v.x()), static_cast<float>(v.y()), static_cast<float>(v.z())});
  }

  void write_hand(const HandJoints* hand) {
    const HandJoints& h = hand ? *hand : absent_;
    header(0, ""), put(static_cast<std::int32_t>(h.id)), put<std::uint8_t>(hand != nullptr),
        put<std::uint8_t>(0);
    put(1.5f), put(h.confidence), put(0.1f), put(0.2f), put(0.3f);
    if (version_ != LeapVersion::release_0_0_14) point(Vector3::UnitX()), point(Vector3::UnitY());
    put(h.grab_strength), put(h.pinch_strength), vector(Vector3(0.1, 0.2, 0.3));
    point(h.palm_centre.value_or(Vector3::Zero())), put(h.palm_width.value_or(0.0f)), put(0.05f), floats({});
    if (version_ != LeapVersion::head) h.wrist ? vector(h.wrist.value()) : floats({});
    if (version_ == LeapVersion::february_2020) vector(Vector3(0.0, 0.1, 0.4));
    text("a hand"), write_fingers(h, hand != nullptr), put<std::uint32_t>(1);
    put<std::int32_t>(1), put<std::uint8_t>(1), put<std::int64_t>(5), put(0.1f), put<std::int32_t>(1);
    put<std::int32_t>(2), text("circle"), put<std::uint32_t>(2), put<std::int32_t>(8), put<std::int32_t>(9);
    if (version_ != LeapVersion::head) return;
    header(0, ""), pose(Vector3(0.0, 0.1, 0.4)), pose(h.wrist.value_or(Vector3::Zero())), floats({}),
        point(Vector3::Zero());
  }

  void write_fingers(const HandJoints& hand, bool present) {
    put(static_cast<std::uint32_t>(present ? kFingers + extra_finger.size() : 0));
    for (std::size_t f = 0; present && f < kFingers; ++f) write_finger(hand, f, static_cast<std::uint8_t>(f));
    for (std::size_t f = 0; present && f < extra_finger.size(); ++f) write_finger(hand, 1, extra_finger[f]);
  }

  void write_finger(const HandJoints& hand, std::size_t f, std::uint8_t type) {
    header(0, ""), put<std::int32_t>(70), put(type), put(0.1f), put(hand.finger_width[f].value_or(0.0f)),
        text("f");
    std::vector<std::uint8_t> bones;
    for (std::uint8_t b = 0; b < kBonesPerFinger; ++b)
      if (hand.joints[f][b] && hand.joints[f][b + 1u]) bones.push_back(b);
    const std::size_t own = bones.size();
    if (f == 1) bones.insert(bones.end(), extra_bone.begin(), extra_bone.end());
    put(static_cast<std::uint32_t>(bones.size()));
    for (std::size_t i = 0; i < bones.size(); ++i) {
      const std::size_t b = i < own ? bones[i] : 1;
      header(0, ""), put(bones[i]), put(0.03f), put(0.018f), text("");
      pose(hand.joints[f][b].value()), pose(hand.joints[f][b + 1].value()), vector(Vector3::Zero());
    }
  }

  LeapVersion version_;
  HandJoints absent_;
  std::vector<std::uint8_t> bytes_;
};

}  // namespace mrhi
