#include "mr_hand_interaction/ros/leap_human.h"

#include <optional>

#include "leap_human_record.h"
#include "wire_reader.h"

namespace mrhi {
namespace {

/// Drivers leave what they do not know at zero; no part of a hand can be exactly at the device's origin.
std::optional<Vector3> known(const Vector3& point) {
  return point == Vector3::Zero() ? std::nullopt : std::make_optional(point);
}
std::optional<float> known(float length) {
  return length == 0.0f ? std::nullopt : std::make_optional(length);
}

HandJoints joints_of(const HandRecord& record, Side side) {
  HandJoints hand;
  hand.id = static_cast<std::uint32_t>(record.id);
  hand.side = side;
  hand.confidence = record.confidence;
  hand.grab_strength = record.grab_strength;
  hand.pinch_strength = record.pinch_strength;
  hand.palm_centre = known(record.palm_centre);
  hand.palm_width = known(record.palm_width);
  hand.wrist = known(record.wrist);
  for (std::size_t f = 0; f < kFingers; ++f) {
    if (!record.fingers[f]) continue;
    hand.finger_width[f] = known(record.fingers[f]->width);
    for (std::size_t b = 0; b < kBonesPerFinger; ++b) {
      if (!record.fingers[f]->bones[b]) continue;
      // A bone starts where the one before it ends; what is not finite must not be covered up.
      auto& joint = hand.joints[f][b];
      if (!joint || joint->allFinite()) joint = record.fingers[f]->bones[b]->start;
      hand.joints[f][b + 1] = record.fingers[f]->bones[b]->end;
    }
  }
  return hand;
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

struct LeapHumanDecoder::Impl {
  explicit Impl(const std::string& definition)
      : layout(definition, "leap_motion/Human"), human(human_reader(layout)) {}

  MessageLayout layout;
  StructReader<HumanRecord> human;
};

LeapHumanDecoder::LeapHumanDecoder(const std::string& message_definition)
    : impl_(std::make_unique<const Impl>(message_definition)) {}

LeapHumanDecoder::~LeapHumanDecoder() = default;

LeapHumanDecoder::Frame LeapHumanDecoder::decode(const std::uint8_t* data, std::size_t size) const {
  WireReader reader(impl_->layout, data, size);
  HumanRecord human;
  impl_->human.read(reader, human);
  if (reader.left() != 0)
    throw DecodeError(DecodeError::Kind::malformed,
                      "message has " + std::to_string(reader.left()) + " bytes more than its definition");
  Frame frame;
  frame.frame_id = human.header.frame_id;
  frame.sequence = human.header.sequence;
  frame.joints.stamp = Nanoseconds(human.header.stamp.seconds) * 1000000000 + human.header.stamp.nanoseconds;
  if (human.right.present) frame.joints.hands.push_back(joints_of(human.right, Side::right));
  if (human.left.present) frame.joints.hands.push_back(joints_of(human.left, Side::left));
  return frame;
}

}  // namespace mrhi
