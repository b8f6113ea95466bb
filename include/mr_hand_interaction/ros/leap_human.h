#pragma once

#include <ros/serialization.h>

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "mr_hand_interaction/tracking/joints.h"

namespace mrhi {

/// Error of a message that cannot be decoded. what() is one line.
class DecodeError : public std::runtime_error {
 public:
  enum class Kind : std::uint8_t {
    unknown_version,  ///< not a known version of leap_motion/Human
    malformed,        ///< the bytes do not fit the type
    wrong_count,      ///< fingers, bones or joints: too many, duplicate, or of unknown type
    unknown_order     ///< the order of joints fits no hand
  };

  DecodeError(Kind kind, const std::string& what) : std::runtime_error(what), kind_(kind) {}
  Kind kind() const { return kind_; }
  /// The kind as text, for counters.
  const char* reason() const;

 private:
  Kind kind_;
};

/// The fields of a leap_motion/Human message that are used.
struct LeapFrame {
  std::string frame_id;        ///< of the header
  std::uint32_t sequence = 0;  ///< of the header
  JointsFrame joints;          ///< stamp of the header, 0 if not set; one entry per hand with is_present
};

/// MD5 of each of the four published versions.
std::vector<std::string> leap_versions();

/// Reads a serialised leap_motion/Human of any published version, by its `md5`. Throws DecodeError.
LeapFrame read_leap(const std::string& md5, std::vector<std::uint8_t> bytes);

/// Reads a serialised leap_motion_controller/Hand as published by casado-fdo/leap-motion-ros: one hand
/// without its wrist, whose side follows from the topic. Throws DecodeError.
LeapFrame read_leap_controller(std::vector<std::uint8_t> bytes);

/// Bytes of a topic_tools::ShapeShifter or a rosbag::MessageInstance.
template <class Message>
std::vector<std::uint8_t> serialised_bytes(const Message& message) {
  std::vector<std::uint8_t> bytes(message.size());
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(message.size()));
  message.write(stream);
  return bytes;
}

/// Reads leap_motion/Human from such a message.
template <class Message>
LeapFrame read_leap(const Message& message) {
  return read_leap(message.getMD5Sum(), serialised_bytes(message));
}

}  // namespace mrhi
