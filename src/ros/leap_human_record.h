#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "message_layout.h"
#include "mr_hand_interaction/tracking/hand.h"
#include "struct_reader.h"

namespace mrhi {

// What is needed of a leap_motion/Human message, in the driver's own terms.

struct Stamp {
  std::uint32_t seconds, nanoseconds;
};
struct HeaderRecord {
  std::uint32_t sequence = 0;
  Stamp stamp{};
  std::string frame_id;
};
struct BoneRecord {
  std::uint8_t type = 0;
  Vector3 start = Vector3::Zero();
  Vector3 end = Vector3::Zero();
};
struct FingerRecord {
  std::uint8_t type = 0;
  float width = 0.0f;
  std::array<std::optional<BoneRecord>, kBonesPerFinger> bones;
};
struct HandRecord {
  bool present = false;
  std::int32_t id = 0;
  float confidence = 0.0f, grab_strength = 0.0f, pinch_strength = 0.0f, palm_width = 0.0f;
  Vector3 palm_centre = Vector3::Zero();
  Vector3 wrist = Vector3::Zero();
  std::array<std::optional<FingerRecord>, kFingers> fingers;
};
struct HumanRecord {
  HeaderRecord header;
  HandRecord right, left;
};

/// Throws DecodeError for a definition that lacks a needed field. Refers to the layout.
StructReader<HumanRecord> human_reader(const MessageLayout& layout);

}  // namespace mrhi
