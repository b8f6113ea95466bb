// A leap_motion/Human whose definition may say what the message is not: two bytes for the length of the
// definition (0: the one that we know), the definition, the message.
#include "fuzz/target.h"
#include "mr_hand_interaction/ros/leap_human.h"
#include "wire/leap_messages.h"

namespace {

using namespace mrhi;

void decode(const LeapHumanDecoder& decoder, const std::uint8_t* data, std::size_t size) {
  try {
    const LeapHumanDecoder::Frame frame = decoder.decode(data, size);
    fuzzing::require(frame.joints.hands.size() <= 2, "a message has at most two hands");
    std::vector<std::string> defects;
    complete_frame(frame.joints, Pose(), defects);
    for (const std::string& defect : defects) fuzzing::require_one_line(defect);
  } catch (const DecodeError& error) {
    fuzzing::require_one_line(error.what());
  }
}

}  // namespace

FUZZ_TARGET(leap) {
  if (size < 2) return;
  const std::size_t length = std::min<std::size_t>(size - 2, data[0] + 256u * data[1]);
  const std::string definition(reinterpret_cast<const char*>(data + 2), length);
  try {
    const LeapHumanDecoder decoder(length > 0 ? definition : leap_definition(LeapVersion::head));
    decode(decoder, data + 2 + length, size - 2 - length);
  } catch (const DecodeError& error) {
    fuzzing::require_one_line(error.what());
  }
}
